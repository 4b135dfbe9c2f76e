//! Whatever a measured file contains, it is read into complete channels or refused with a message.

use qcar_signals::read::recognise;
use qcar_signals::signal::{Recording, TimeBase};

/// Fails if a reader panics, or if a channel and its times differ in length.
pub fn survives(bytes: &[u8]) {
    match recognise(bytes) {
        Ok(recording) => whole(&recording),
        Err(fault) => assert!(!fault.to_string().is_empty()),
    }
}

fn whole(recording: &Recording) {
    for signal in &recording.signals {
        if let TimeBase::Times(times) = &signal.time {
            assert_eq!(times.len(), signal.samples.len(), "{}", signal.name);
            assert!(
                times.is_sorted() && times.iter().all(|time| time.is_finite()),
                "{}",
                signal.name
            );
        }
    }
}
