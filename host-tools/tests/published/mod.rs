//! The paper's 18 points in the shapes in which authors publish tables.

use std::fmt::Write;

use rust_xlsxwriter::Workbook;

pub const ROBOT: &str = include_str!("../../../tests/data/seed-table-8/robot.toml");
/// As they are shipped.
pub const SHIPPED: &str = include_str!("../../../tests/data/seed-table-8/measurements.csv");

/// What every import of them must give: no zeros behind the last digit.
pub fn plain() -> String {
    let header = SHIPPED.lines().next().unwrap().to_owned() + "\n";
    text(&header, &rows(), ",", ".")
}

/// Joints in degrees and points in mm.
pub fn rows() -> Vec<Vec<f64>> {
    let row = |line: &str| line.split(',').map(|cell| cell.parse().unwrap()).collect();
    SHIPPED.lines().skip(1).map(row).collect()
}

/// With joints in radians and points in metres, as asked.
pub fn scaled(radians: bool, metres: bool) -> Vec<Vec<f64>> {
    let cell = |(i, v): (usize, &f64)| match i {
        0..6 if radians => v.to_radians(),
        6.. if metres => v / 1e3,
        _ => *v,
    };
    rows().iter().map(|row| row.iter().enumerate().map(cell).collect()).collect()
}

/// Lines of cells.
pub fn text(header: &str, rows: &[Vec<f64>], delimiter: &str, decimal: &str) -> String {
    let mut out = header.to_owned();
    for row in rows {
        let cells: Vec<String> = row.iter().map(|v| v.to_string().replace('.', decimal)).collect();
        writeln!(out, "{}", cells.join(delimiter)).unwrap();
    }
    out
}

/// Text as UTF-16 with a byte-order mark.
pub fn utf16(text: &str, little: bool) -> Vec<u8> {
    let units = std::iter::once(0xfeff).chain(text.encode_utf16());
    units.flat_map(|u| if little { u.to_le_bytes() } else { u.to_be_bytes() }).collect()
}

/// Text whose letters all are of Latin-1.
pub fn latin1(text: &str) -> Vec<u8> {
    text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect()
}

/// A workbook: a page of remarks, then the table under a line of title.
pub fn xlsx(title: &str, header: &[&str], rows: &[Vec<f64>]) -> Vec<u8> {
    let mut book = Workbook::new();
    book.add_worksheet().set_name("Info").unwrap().write(0, 0, "measured by hand").unwrap();
    let sheet = book.add_worksheet().set_name("Measurements").unwrap();
    sheet.write(0, 0, title).unwrap();
    for (column, name) in header.iter().enumerate() {
        sheet.write(2, column as u16, *name).unwrap();
    }
    for (i, row) in rows.iter().enumerate() {
        for (column, value) in row.iter().enumerate() {
            sheet.write(i as u32 + 3, column as u16, *value).unwrap();
        }
    }
    book.save_to_buffer().unwrap()
}

/// An OpenDocument sheet: the files that a reader needs.
pub fn ods(header: &[&str], rows: &[Vec<f64>]) -> Vec<u8> {
    let mut table = String::from("<table:table-row>");
    for name in header {
        let cell = format!("<text:p>{name}</text:p>");
        write!(table, "<table:table-cell office:value-type=\"string\">{cell}</table:table-cell>")
            .unwrap();
    }
    table += "</table:table-row>";
    for row in rows {
        table += "<table:table-row>";
        for v in row {
            let value = format!("office:value-type=\"float\" office:value=\"{v}\"");
            write!(table, "<table:table-cell {value}><text:p>{v}</text:p></table:table-cell>")
                .unwrap();
        }
        table += "</table:table-row>";
    }
    let content = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?><office:document-content \
         xmlns:office=\"urn:oasis:names:tc:opendocument:xmlns:office:1.0\" \
         xmlns:table=\"urn:oasis:names:tc:opendocument:xmlns:table:1.0\" \
         xmlns:text=\"urn:oasis:names:tc:opendocument:xmlns:text:1.0\" office:version=\"1.2\">\
         <office:body><office:spreadsheet><table:table table:name=\"Tabelle1\">{table}</table:table>\
         </office:spreadsheet></office:body></office:document-content>"
    );
    let kind = "application/vnd.oasis.opendocument.spreadsheet";
    let manifest = "<?xml version=\"1.0\" encoding=\"UTF-8\"?><manifest:manifest \
                    xmlns:manifest=\"urn:oasis:names:tc:opendocument:xmlns:manifest:1.0\"/>";
    zip(&[
        ("mimetype", kind.as_bytes()),
        ("META-INF/manifest.xml", manifest.as_bytes()),
        ("content.xml", content.as_bytes()),
    ])
}

/// A ZIP archive of stored files (PKWARE's APPNOTE 4.3).
fn zip(files: &[(&str, &[u8])]) -> Vec<u8> {
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
    let (mut out, mut directory) = (Vec::new(), Vec::new());
    for (name, bytes) in files {
        let offset = out.len() as u32;
        let size = (bytes.len() as u32).to_le_bytes();
        let mut common = vec![20, 0, 0, 0, 0, 0, 0, 0, 0x21, 0];
        common.extend(crc.checksum(bytes).to_le_bytes());
        common.extend([size, size].concat());
        common.extend((name.len() as u16).to_le_bytes());
        common.extend([0, 0]);
        out.extend(b"PK\x03\x04");
        out.extend(&common);
        out.extend(name.as_bytes());
        out.extend(*bytes);
        directory.extend(b"PK\x01\x02\x14\x00");
        directory.extend(&common);
        directory.extend([0; 10]);
        directory.extend(offset.to_le_bytes());
        directory.extend(name.as_bytes());
    }
    let (start, length, count) = (out.len() as u32, directory.len() as u32, files.len() as u16);
    out.extend(directory);
    out.extend(b"PK\x05\x06\0\0\0\0");
    out.extend([count.to_le_bytes(), count.to_le_bytes()].concat());
    out.extend([length.to_le_bytes(), start.to_le_bytes()].concat());
    out.extend([0, 0]);
    out
}
