//! TDMS, the format of LabVIEW: segments, each with a list of objects and their raw data, in either byte order,
//! interleaved or not, or as DAQmx writes them.
//!
//! Source: "TDMS File Format Internal Structure" of National Instruments.

// The description of an object.
mod metadata;
// From raw to physical values.
mod scaling;

use std::collections::HashMap;

use crate::bytes::{Bytes, Order, heads};
use crate::error::{Fault, Place, Read, whole_before};
use crate::find::Wanted;
use crate::signal::{Recording, Signal, Source, TimeBase, evenly};
use crate::units::{in_seconds, is_time, name_and_unit, seconds};

use metadata::{Index, Layout, Properties, STAMP, Scaler, object};
use scaling::Scaling;

/// The first bytes of a segment.
pub(crate) const MAGIC: &[u8] = b"TDSm";
/// Bytes of the lead-in of a segment: tag 4, contents 4, version 4, length 8, place of raw data 8.
const LEAD_IN: u64 = 28;

const HAS_METADATA: u32 = 1 << 1;
const NEW_LIST: u32 = 1 << 2;
const HAS_RAW_DATA: u32 = 1 << 3;
const INTERLEAVED: u32 = 1 << 5;
const BIG_ENDIAN: u32 = 1 << 6;

/// Reads all segments of a file.
pub(crate) fn read(bytes: Bytes, wanted: &Wanted) -> Read<Recording> {
    let mut file = File::default();
    let mut at = 0;
    let mut number = 1;
    while at < bytes.len() {
        let lead_in = bytes.part(at, LEAD_IN, "a segment's lead-in")?;
        if !lead_in.starts_with(MAGIC) {
            return Err(Fault::damaged(
                Place::Byte(at),
                "something else",
                format!("segment {number} (`TDSm`)"),
            ));
        }
        let contents = lead_in.u32(4, "contents")?;
        let order = if contents & BIG_ENDIAN == 0 {
            Order::Little
        } else {
            Order::Big
        };
        let lead_in = lead_in.in_order(order);
        let (length, raw) = (lead_in.u64(12, "a length")?, lead_in.u64(20, "the place of raw data")?);
        let segment = segment(&bytes.in_order(order), at, length, raw, number)?;
        file.add(&segment, contents, raw, number, wanted)?;
        at = at.saturating_add(LEAD_IN).saturating_add(length);
        number += 1;
    }
    file.recording()
}

/// The bytes after the lead-in of a segment, which must be complete.
fn segment<'a>(file: &Bytes<'a>, at: u64, length: u64, raw: u64, number: u32) -> Read<Bytes<'a>> {
    let there = file.len() - at - LEAD_IN;
    if length > there {
        let found = format!(
            "{} bytes of data in segment {number}{}",
            there.saturating_sub(raw),
            whole_before(number as usize - 1, "segment")
        );
        return Err(match length {
            u64::MAX => {
                let expected = "a segment whose length was written when it was finished";
                let remedy = "the recording was interrupted: open and save the file in the program that recorded it";
                Fault::new(Place::Byte(at), found, expected, remedy)
            }
            _ => {
                let declared = format!("{} bytes of data", length.saturating_sub(raw));
                Fault::cut_off(Place::Byte(at), found, declared)
            }
        });
    }
    file.part(at + LEAD_IN, length, "a segment")
}

/// The part of a file that was read so far.
#[derive(Default)]
struct File {
    objects: Vec<Object>,
    by_path: HashMap<String, usize>,
    /// Objects with raw data in a segment, in their order.
    active: Vec<usize>,
    /// The first time stamp, from which the seconds of all of them count.
    origin: Origin,
}

/// The first time stamp of a file, in parts of 2^-64 s. A stamp has 8 bytes of a fraction and 8 of seconds, in the order
/// of the file.
#[derive(Default)]
struct Origin(Option<i128>);

impl Origin {
    /// Appends the seconds from the origin to the stamps that begin every `stride` bytes of `data`.
    fn extend(&mut self, into: &mut Vec<f64>, data: &[u8], stride: usize, order: Order) {
        into.extend(heads(data, stride).map(|bytes| {
            let stamp = match order {
                Order::Little => i128::from_le_bytes(bytes),
                Order::Big => i128::from_be_bytes(bytes),
            };
            let passed = stamp.wrapping_sub(*self.0.get_or_insert(stamp));
            passed as f64 / 2_f64.powi(64)
        }));
    }
}

/// A channel, a group or the file itself.
struct Object {
    path: String,
    wanted: bool,
    place: Place,
    properties: Properties,
    /// Arrangement of its raw data in the present segment.
    index: Option<Index>,
    active: bool,
    has_stamps: bool,
    /// Raw values, of time stamps the seconds; for DAQmx data, a list for each scaler.
    raw: Vec<(Option<u32>, Vec<f64>)>,
    /// Reason why its data are left out.
    unread: Option<String>,
}

impl File {
    fn add(&mut self, segment: &Bytes, contents: u32, raw: u64, number: u32, wanted: &Wanted) -> Read<()> {
        if contents & HAS_METADATA != 0 {
            if contents & NEW_LIST != 0 {
                self.active
                    .drain(..)
                    .for_each(|active| self.objects[active].active = false);
            }
            self.add_objects(segment, raw, wanted)?;
        }
        if contents & HAS_RAW_DATA == 0 {
            return Ok(());
        }
        let place = segment.place(raw);
        let length = segment.len().checked_sub(raw).ok_or_else(|| {
            let found = format!(
                "raw data from byte {raw} on in segment {number} of {} bytes",
                segment.len()
            );
            Fault::damaged(segment.place(0), found, "raw data within the segment")
        })?;
        let data = segment.part(raw, length, "raw data")?;
        let indices = self
            .active
            .iter()
            .filter_map(|&at| Some((at, self.objects[at].index.clone()?)));
        let used: Vec<(usize, Index)> = indices.filter(|(_, index)| index.count > 0).collect();
        let interleaved = contents & INTERLEAVED != 0;
        let has_others = used
            .iter()
            .any(|(_, index)| matches!(index.layout, Layout::Unread { .. }));
        if interleaved && has_others {
            let remedy = "export the file without interleaving";
            return Err(Fault::new(
                place,
                "numbers interleaved with other data",
                "interleaved numbers",
                remedy,
            ));
        }
        let chunk = metadata::chunk(&used)
            .ok_or_else(|| Fault::damaged(place.clone(), "sizes that overflow", "sizes within the segment"))?;
        if chunk == 0 || length % chunk != 0 {
            if length == 0 {
                return Ok(());
            }
            let found = format!("{length} bytes of data in segment {number}");
            return Err(Fault::damaged(place, found, format!("whole chunks of {chunk} bytes")));
        }
        for at in (0..length / chunk).map(|number| number * chunk) {
            self.add_chunk(&data.part(at, chunk, "a chunk")?, &used, interleaved)?;
        }
        Ok(())
    }

    fn add_objects(&mut self, segment: &Bytes, raw: u64, wanted: &Wanted) -> Read<()> {
        let metadata = segment.part(0, raw.min(segment.len()), "objects")?;
        let mut at = 4;
        for _ in 0..metadata.u32(0, "a number of objects")? {
            let place = metadata.place(at);
            let known = |path: &str| {
                self.by_path
                    .get(path)
                    .and_then(|&known| self.objects[known].index.clone())
            };
            let new = object(&metadata, &mut at, &known)?;
            let index = *self.by_path.entry(new.path.clone()).or_insert_with(|| {
                self.objects.push(Object {
                    path: new.path.clone(),
                    wanted: is_read(&new.path, wanted),
                    place,
                    properties: Properties::default(),
                    index: None,
                    active: false,
                    has_stamps: false,
                    raw: Vec::new(),
                    unread: None,
                });
                self.objects.len() - 1
            });
            let object = &mut self.objects[index];
            object.properties.extend(new.properties);
            object.index = new.index;
            let has_stamps = matches!(&object.index, Some(index) if matches!(index.layout, Layout::Stamps));
            object.has_stamps |= has_stamps;
            object.wanted |= has_stamps;
            let was_active = std::mem::replace(&mut object.active, object.index.is_some());
            match (was_active, object.active) {
                (false, true) => self.active.push(index),
                (true, false) => self.active.retain(|&active| active != index),
                _ => {}
            }
        }
        Ok(())
    }

    /// Reads the data of the wanted objects in a chunk.
    fn add_chunk(&mut self, chunk: &Bytes, used: &[(usize, Index)], interleaved: bool) -> Read<()> {
        if interleaved {
            self.add_rows(chunk, used)?;
        }
        let (order, mut at) = (chunk.order, 0);
        for (object, index) in used {
            let object = &mut self.objects[*object];
            match &index.layout {
                Layout::Plain(_) | Layout::Stamps if interleaved => {}
                Layout::Stamps => {
                    let size = STAMP * index.count;
                    let own = object.raw_of(None);
                    chunk.pieces(at, size, STAMP, "time stamps", |piece| {
                        self.origin.extend(own, piece, STAMP as usize, order);
                    })?;
                    at += size;
                }
                Layout::Plain(number) => {
                    let size = number.size() as u64 * index.count;
                    if object.wanted {
                        let own = object.raw_of(None);
                        own.reserve(index.count as usize);
                        chunk.pieces(at, size, number.size() as u64, "raw data", |piece| {
                            number.extend(own, piece, number.size(), order);
                        })?;
                    }
                    at += size;
                }
                Layout::Unread { bytes, why } => {
                    object.unread = Some(why.clone());
                    at += *bytes;
                }
                Layout::Daqmx { scalers, .. } if object.wanted => {
                    for scaler in scalers {
                        if let Some(buffer) = metadata::buffer(used, chunk, scaler.buffer)? {
                            object.add_daqmx(scaler, &buffer, order)?;
                        }
                    }
                }
                Layout::Daqmx { .. } => {}
            }
        }
        Ok(())
    }

    /// Reads a chunk in which each row has a value of each object.
    fn add_rows(&mut self, chunk: &Bytes, used: &[(usize, Index)]) -> Read<()> {
        let stride: u64 = used.iter().filter_map(|(_, index)| index.size()).sum();
        chunk.pieces(0, chunk.len(), stride, "raw data", |rows| {
            let mut column = 0;
            for (object, index) in used {
                let object = &mut self.objects[*object];
                let (values, stride) = (&rows[column..], stride as usize);
                match &index.layout {
                    Layout::Plain(number) if object.wanted => {
                        number.extend(object.raw_of(None), values, stride, chunk.order);
                    }
                    Layout::Stamps => self.origin.extend(object.raw_of(None), values, stride, chunk.order),
                    _ => {}
                }
                column += index.size().unwrap_or(0) as usize;
            }
        })
    }

    fn recording(mut self) -> Read<Recording> {
        let mut recording = Recording::new("TDMS");
        let mut channels = Vec::new();
        for object in &mut self.objects {
            let Some((group, name)) = channel_of(&object.path) else {
                continue;
            };
            match object.values() {
                Ok(samples) => channels.push((group, name, &*object, samples)),
                Err(why) => recording.pass_over(name, object.place.clone(), why),
            }
        }
        let times = times_of_groups(&channels)?;
        for (group, name, object, samples) in channels {
            let of_group = times.get(&group).filter(|_| object.step().is_none());
            if of_group.is_some() && object.has_times(&name) {
                continue;
            }
            let time = match (object.step(), of_group) {
                (Some((start, step)), _) => {
                    evenly(start, step, object.place.clone()).map_err(|fault| fault.of(&name))?
                }
                (None, Some(TimeBase::Times(times))) if times.len() == samples.len() => TimeBase::Times(times.clone()),
                _ => TimeBase::Unknown,
            };
            recording.signals.push(Signal {
                name,
                unit: object.unit(),
                time,
                samples: samples.into(),
                labels: Vec::new(),
                source: Source {
                    group,
                    place: object.place.clone(),
                },
            });
        }
        Ok(recording)
    }
}

/// A channel: group, name, object and samples.
type Channel<'a> = (String, String, &'a Object, Vec<f64>);

/// The times that a channel of a group states, where another channel of it has no step of its own.
fn times_of_groups(channels: &[Channel<'_>]) -> Read<HashMap<String, TimeBase>> {
    let is_untimed = |group: &str| {
        let mut of_group = channels.iter().filter(|(own, ..)| own == group);
        of_group.any(|(_, _, object, _)| object.step().is_none())
    };
    let mut times = HashMap::new();
    for (group, name, object, samples) in channels {
        let unit = match object.unit() {
            unit if unit.is_empty() => name_and_unit(name).1,
            unit => unit,
        };
        let factor = if object.has_stamps { Some(1.0) } else { seconds(&unit) };
        let Some(factor) = factor.filter(|_| object.has_times(name) && is_untimed(group)) else {
            continue;
        };
        let mut own = samples.clone();
        in_seconds(&mut own, factor);
        let base = TimeBase::from_times(own).map_err(|(at, found)| {
            Fault::damaged(
                object.place.clone(),
                format!("{found} in sample {}", at + 1),
                "times that never decrease",
            )
            .of(name)
        })?;
        times.insert(group.clone(), base);
    }
    Ok(times)
}

impl Object {
    fn raw_of(&mut self, scaler: Option<u32>) -> &mut Vec<f64> {
        let known = self.raw.iter().position(|(own, _)| *own == scaler);
        let at = known.unwrap_or_else(|| {
            self.raw.push((scaler, Vec::new()));
            self.raw.len() - 1
        });
        &mut self.raw[at].1
    }

    fn add_daqmx(&mut self, scaler: &Scaler, (buffer, width): &(Bytes, u64), order: Order) -> Read<()> {
        let own = self.raw_of(Some(scaler.id));
        buffer.pieces(0, buffer.len(), *width, "raw data", |rows| {
            let from = rows.get(scaler.byte as usize..).unwrap_or(&[]);
            scaler.number.extend(own, from, *width as usize, order);
        })
    }

    /// Physical values, or why there are none.
    fn values(&mut self) -> Result<Vec<f64>, String> {
        match &self.unread {
            Some(why) => Err(why.clone()),
            None => Scaling::of(&self.properties)?.apply(std::mem::take(&mut self.raw)),
        }
    }

    /// Start and step of a waveform.
    fn step(&self) -> Option<(f64, f64)> {
        let step = self.properties.number("wf_increment").filter(|&step| step != 0.0)?;
        Some((self.properties.number("wf_start_offset").unwrap_or(0.0), step))
    }

    /// True if a channel of this name may have the times of its group.
    fn has_times(&self, name: &str) -> bool {
        self.has_stamps || has_times(name)
    }

    fn unit(&self) -> String {
        if self.has_stamps {
            return "s".into();
        }
        let text = ["unit_string", "NI_UnitDescription", "unit", "Unit"];
        text.iter()
            .find_map(|name| self.properties.text(name))
            .unwrap_or("")
            .into()
    }
}

/// True if a channel of this name, which may end with a unit, has the times of its group.
fn has_times(name: &str) -> bool {
    is_time(&name_and_unit(name).0)
}

/// True if the values of an object are read: for a wanted channel, and for a channel that may be its times.
fn is_read(path: &str, wanted: &Wanted) -> bool {
    channel_of(path).is_some_and(|(group, name)| wanted.has(&group, &name) || has_times(&name))
}

/// Group and channel of a path such as `/'rig'/'wheel_left_z'`; a quote within a name is doubled.
fn channel_of(path: &str) -> Option<(String, String)> {
    let (group, channel) = path.strip_prefix("/'")?.strip_suffix('\'')?.split_once("'/'")?;
    Some((group.replace("''", "'"), channel.replace("''", "'")))
}
