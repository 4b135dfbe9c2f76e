//! Writes MDF 4.10: sorted and not packed, with a group for each time base.
//!
//! Source: public descriptions and open readers of ASAM MDF 4.1.

/// Channels that were sampled together.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Name.
    pub name: String,
    /// Times of the samples, s; finite and increasing.
    pub times: Vec<f64>,
    /// The channels, each with as many samples as there are times.
    pub channels: Vec<Channel>,
}

/// A channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Name.
    pub name: String,
    /// The unit of its samples.
    pub unit: String,
    /// The samples.
    pub samples: Vec<f64>,
}

const IDENTIFICATION: usize = 64;
/// Bytes of the head of a block; a block of text or data has no links after it.
const HEAD: usize = 24;
const MASTER: u8 = 2;
const TIME: u8 = 1;
const FLOAT: u8 = 4;
const BITS: u32 = 64;

/// A file with these groups; `tool` is the name of the writing program. The start time is 1 January 1970, since
/// computed data have no date.
pub fn v4(tool: &str, groups: &[Group]) -> Vec<u8> {
    let mut file = File(identification(tool));
    // The header comes first; the blocks of its links are not written yet.
    let header = file.block(b"HD", &[0; 6], &[0; 32]);
    let comment = format!("<FHcomment><TX/><tool_id>{tool}</tool_id><tool_vendor/><tool_version/></FHcomment>");
    let comment = file.text(b"MD", &comment);
    let history = file.block(b"FH", &[0, comment], &[0; 16]);
    let mut first = 0;
    // The last group is written first, since each has a link to the next.
    for group in groups.iter().rev() {
        first = file.group(group, first);
    }
    file.link(header, 0, first);
    file.link(header, 1, history);
    file.0
}

fn identification(tool: &str) -> Vec<u8> {
    let mut block = b"MDF     4.10    ".to_vec();
    block.extend(tool.bytes().chain(std::iter::repeat(b' ')).take(8));
    block.extend([0; 4]);
    block.extend(410u16.to_le_bytes());
    block.resize(IDENTIFICATION, 0);
    block
}

/// The part of a file that is written.
struct File(Vec<u8>);

impl File {
    /// Adds a block at a multiple of eight bytes and returns its position.
    fn block(&mut self, kind: &[u8; 2], links: &[u64], data: &[u8]) -> u64 {
        self.0.resize(self.0.len().next_multiple_of(8), 0);
        let place = self.0.len() as u64;
        let length = HEAD + 8 * links.len() + data.len();
        self.0.extend([b'#', b'#', kind[0], kind[1], 0, 0, 0, 0]);
        self.0.extend((length as u64).to_le_bytes());
        self.0.extend((links.len() as u64).to_le_bytes());
        self.0.extend(links.iter().flat_map(|link| link.to_le_bytes()));
        self.0.extend(data);
        place
    }

    /// Sets a link of an existing block to a position.
    fn link(&mut self, block: u64, link: usize, to: u64) {
        let at = block as usize + HEAD + 8 * link;
        self.0[at..at + 8].copy_from_slice(&to.to_le_bytes());
    }

    /// A text, terminated by a zero and padded to a multiple of eight bytes.
    fn text(&mut self, kind: &[u8; 2], text: &str) -> u64 {
        let mut data = text.as_bytes().to_vec();
        data.resize((data.len() + 1).next_multiple_of(8), 0);
        self.block(kind, &[], &data)
    }

    fn group(&mut self, group: &Group, next: u64) -> u64 {
        let records = records(group);
        let data = self.block(b"DT", &[], &records);
        let mut first = 0;
        for (place, own) in group.channels.iter().enumerate().rev() {
            first = self.channel(&own.name, &own.unit, [0, 0], place as u32 + 1, first);
        }
        first = self.channel("time", "s", [MASTER, TIME], 0, first);
        let name = self.text(b"TX", &group.name);
        let width = 8 * (group.channels.len() as u32 + 1);
        let mut about = vec![0; 8];
        about.extend((group.times.len() as u64).to_le_bytes());
        about.extend([0; 8]);
        about.extend(width.to_le_bytes());
        about.extend([0; 4]);
        let channels = self.block(b"CG", &[0, first, name, 0, 0, 0], &about);
        self.block(b"DG", &[next, channels, data, 0], &[0; 8])
    }

    /// A channel of type and synchronisation `kinds`, at a position in the record.
    fn channel(&mut self, name: &str, unit: &str, kinds: [u8; 2], place: u32, next: u64) -> u64 {
        let (name, unit) = (self.text(b"TX", name), self.text(b"TX", unit));
        let mut about = vec![kinds[0], kinds[1], FLOAT, 0];
        about.extend((8 * place).to_le_bytes());
        about.extend(BITS.to_le_bytes());
        // Flags, invalidation, precision, attachments, and ranges, which are not stated.
        about.resize(72, 0);
        self.block(b"CN", &[next, 0, name, 0, 0, 0, unit, 0], &about)
    }
}

/// Time, then every channel, sample by sample.
fn records(group: &Group) -> Vec<u8> {
    let record = |(at, time): (usize, &f64)| {
        let samples = group.channels.iter().map(move |own| own.samples[at]);
        std::iter::once(*time).chain(samples).flat_map(f64::to_le_bytes)
    };
    group.times.iter().enumerate().flat_map(record).collect()
}
