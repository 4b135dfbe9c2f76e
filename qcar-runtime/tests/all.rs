//! The workbench as those who call it see it.

mod campaign;
mod compare;
mod contact;
mod damaged;
mod discover;
mod exponential;
mod fit;
mod harmonics;
mod kc;
mod least_squares;
mod modes;
mod passage;
mod periodic;
mod response;
mod ride;
mod road;
mod roller;
mod sampling;
mod sensitivity;
mod shipped_campaigns;
mod solver;
mod spectrum;
mod support;
mod target;
mod transmissibility;
mod unsteady;
