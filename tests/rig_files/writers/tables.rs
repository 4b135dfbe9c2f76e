//! Tables: a text as a German logger writes it, and a workbook of Excel.

use std::fmt::Write as _;

use flate2::Crc;

use super::Group;

/// Semicolons, decimal commas, a row of units and a byte order mark.
pub fn text(group: &Group) -> Vec<u8> {
    let head = |of: fn(&super::Channel) -> &String| {
        group
            .channels
            .iter()
            .map(of)
            .map(|cell| format!(";{cell}"))
            .collect::<String>()
    };
    let mut text = format!(
        "\u{feff}Zeit{}\r\ns{}\r\n",
        head(|own| &own.name),
        head(|own| &own.unit)
    );
    for sample in 0..group.len() {
        let mut row = format!("{}", group.time(sample));
        group
            .channels
            .iter()
            .for_each(|channel| row += &format!(";{}", channel.samples[sample]));
        text += &row.replace('.', ",");
        text += "\r\n";
    }
    text.into_bytes()
}

/// A sheet with names, units and rows of numbers.
pub fn workbook(group: &Group) -> Vec<u8> {
    let mut sheet =
        r#"<worksheet xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"><sheetData>"#.to_string();
    let words = |text: &str| format!(r#"<c t="inlineStr"><is><t>{text}</t></is></c>"#);
    for (first, of) in [
        ("Time", (|own| &own.name) as fn(&super::Channel) -> &String),
        ("s", |own| &own.unit),
    ] {
        let cells: String = group.channels.iter().map(of).map(|text| words(text)).collect();
        let _ = write!(sheet, "<row>{}{cells}</row>", words(first));
    }
    for sample in 0..group.len() {
        let _ = write!(sheet, "<row><c><v>{}</v></c>", group.time(sample));
        group.channels.iter().for_each(|channel| {
            let _ = write!(sheet, "<c><v>{}</v></c>", channel.samples[sample]);
        });
        sheet += "</row>";
    }
    sheet += "</sheetData></worksheet>";
    const PARTS: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    let relation = |kind: &str, target: &str| {
        format!(
            r#"<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="r1" Type="{PARTS}/{kind}" Target="{target}"/></Relationships>"#
        )
    };
    let book = format!(
        r#"<workbook xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main" xmlns:r="{PARTS}"><sheets><sheet name="rig" sheetId="1" r:id="r1"/></sheets></workbook>"#
    );
    archive(&[
        ("_rels/.rels", relation("officeDocument", "xl/workbook.xml")),
        (
            "xl/_rels/workbook.xml.rels",
            relation("worksheet", "worksheets/sheet1.xml"),
        ),
        ("xl/workbook.xml", book),
        ("xl/worksheets/sheet1.xml", sheet),
    ])
}

/// A ZIP archive whose entries are not packed.
fn archive(entries: &[(&str, String)]) -> Vec<u8> {
    let (mut file, mut directory) = (Vec::new(), Vec::new());
    for (name, content) in entries {
        let mut crc = Crc::new();
        crc.update(content.as_bytes());
        let at = file.len() as u32;
        let mut facts = [20u16, 0, 0, 0, 0].map(u16::to_le_bytes).concat();
        facts.extend(
            [crc.sum(), content.len() as u32, content.len() as u32]
                .map(u32::to_le_bytes)
                .concat(),
        );
        facts.extend([name.len() as u16, 0].map(u16::to_le_bytes).concat());
        file.extend(b"PK\x03\x04");
        file.extend(&facts);
        file.extend(name.as_bytes());
        file.extend(content.as_bytes());
        directory.extend(b"PK\x01\x02\x14\x00");
        directory.extend(&facts);
        directory.extend([0; 10]);
        directory.extend(at.to_le_bytes());
        directory.extend(name.as_bytes());
    }
    let (at, count) = (file.len() as u32, entries.len() as u16);
    let length = directory.len() as u32;
    file.extend(directory);
    file.extend(b"PK\x05\x06\0\0\0\0");
    file.extend([count, count].map(u16::to_le_bytes).concat());
    file.extend([length, at].map(u32::to_le_bytes).concat());
    file.extend([0; 2]);
    file
}
