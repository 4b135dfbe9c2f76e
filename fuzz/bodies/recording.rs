//! Whatever a measured file holds, it is read into whole channels, or refused with a message.

use qcar_signals::read::recognise;
use qcar_signals::signal::{Recording, TimeBase};

/// Fails where a reader panics, or gives a channel that is not as long as its times.
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
