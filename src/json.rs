//! Results as JSON.

use serde::{Serialize, Serializer};

/// A JSON object whose keys keep their order.
pub struct Ordered<T>(pub Vec<(String, T)>);

impl<T: Serialize> Serialize for Ordered<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(key, value)| (key, value)))
    }
}

impl<T> FromIterator<(String, T)> for Ordered<T> {
    fn from_iter<I: IntoIterator<Item = (String, T)>>(entries: I) -> Self {
        Ordered(entries.into_iter().collect())
    }
}

/// One line of JSON with its end of line. The types of this crate always serialise.
pub fn line(value: &impl Serialize) -> String {
    let mut text = serde_json::to_string(value).expect("keys are strings and no field refuses");
    text.push('\n');
    text
}

/// JSON that is safe inside a script element of a page.
pub fn inert(value: &impl Serialize) -> String {
    let json = serde_json::to_string(value).expect("keys are strings and no field refuses");
    json.replace('<', "\\u003c")
}
