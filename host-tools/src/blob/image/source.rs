use std::fmt::Write;

use truearm::blob::Blob;

/// What a reader of the source wants to know of the bytes, a line each.
fn about(blob: &Blob) -> [String; 3] {
    let created = std::time::Duration::from_secs(u64::from(blob.created()));
    let curves = match blob.curves().iter().count() {
        0 => String::new(),
        count => format!("{count} curves, "),
    };
    [
        "Parameters of one robot arm, packed by truearm; do not edit.".to_owned(),
        format!("robot id {:#018x}, sequence {}", blob.robot_id(), blob.sequence()),
        format!(
            "created {}, {} joints, {} terms, {}{} bytes",
            humantime::format_rfc3339_seconds(std::time::UNIX_EPOCH + created),
            blob.joints(),
            blob.terms(),
            curves,
            blob.size()
        ),
    ]
}

fn lines(bytes: &[u8], prefix: &str) -> String {
    let mut text = String::new();
    for line in bytes.chunks(16) {
        let numbers: Vec<String> = line.iter().map(|b| format!("{b:#04x}")).collect();
        let _ = writeln!(text, "{prefix}{},", numbers.join(", "));
    }
    text
}

/// A C source file, C11 or C++11: `const uint8_t truearm_parameters[]`.
#[must_use]
pub fn c(bytes: &[u8], blob: &Blob) -> String {
    let about = about(blob).map(|line| format!(" * {line}\n")).concat();
    let size = bytes.len();
    format!(
        "/*\n{about} */\n#include <stdint.h>\n\n\
         #ifdef __cplusplus\nextern \"C\" {{\n\
         alignas(4) extern const uint8_t truearm_parameters[{size}];\n\
         extern const uint32_t truearm_parameters_size;\n\
         alignas(4)\n#else\n_Alignas(4)\n#endif\n\
         const uint8_t truearm_parameters[{size}] = {{\n{}}};\n\
         const uint32_t truearm_parameters_size = {size};\n\
         #ifdef __cplusplus\n}}\n#endif\n",
        lines(bytes, "    ")
    )
}

/// A Rust source file, to be included as a module: `static PARAMETERS`.
#[must_use]
pub fn rust(bytes: &[u8], blob: &Blob) -> String {
    let about = about(blob).map(|line| format!("/// {line}\n")).concat();
    format!("{about}pub static PARAMETERS: [u8; {}] = [\n{}];\n", bytes.len(), lines(bytes, "    "))
}
