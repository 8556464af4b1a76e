//! The page of the reports' fields, of their schemas.

use std::collections::BTreeMap;

use serde_json::Value;
use truearm_host::report::schema;

const HEAD: &str = "\
# Reports for programs

`report.json`, and what a verb prints with `--json`, has a schema, named under `schema` in it. A field is always there unless
its type says \"may be missing\". Records that several reports share, or that stand within others, are at the end under [Parts](#parts).
Where a number has a unit, its name ends with it.
";

/// The whole page.
pub fn page() -> String {
    let mut text = HEAD.to_owned();
    let mut parts: BTreeMap<String, Value> = BTreeMap::new();
    for (name, schema) in schema::all() {
        let schema: Value = serde_json::from_str(&schema).unwrap();
        let definitions = schema["$defs"].as_object().cloned().unwrap_or_default();
        text += &format!("\n## {name}\n\n{} [Schema](schemas/{name}.json).\n\n", said(&schema));
        text += &table(&schema, &definitions);
        for (part, value) in &definitions {
            if value["properties"].is_null() {
                continue;
            }
            let section = format!("{}\n\n{}", said(value), table(value, &definitions));
            let known = parts.entry(part.clone()).or_insert_with(|| section.clone().into());
            assert_eq!(*known, section, "two records are called {part}");
        }
    }
    text += "\n## Parts\n";
    for (part, section) in &parts {
        text += &format!("\n### {part}\n\n{}", section.as_str().unwrap());
    }
    text
}

type Definitions = serde_json::Map<String, Value>;

fn table(record: &Value, definitions: &Definitions) -> String {
    let required = record["required"].as_array().cloned().unwrap_or_default();
    let rows = record["properties"].as_object().unwrap().iter().map(|(field, value)| {
        let missing =
            if required.contains(&Value::from(field.as_str())) { "" } else { "; may be missing" };
        let meaning = [said(value), variants(value, definitions)].concat();
        format!("| `{field}` | {}{missing} | {meaning} |\n", kind(value, definitions))
    });
    "| field | type | meaning |\n|---|---|---|\n".to_owned() + &rows.collect::<String>()
}

/// Its description in one line.
fn said(value: &Value) -> String {
    let text = value["description"].as_str().unwrap_or_default();
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ").replace('|', "\\|")
}

/// Of a field that is one of some words: what each of them says.
fn variants(value: &Value, definitions: &Definitions) -> String {
    let Some(all) = referred(value, definitions).and_then(|part| part["oneOf"].as_array()) else {
        return String::new();
    };
    let each = all.iter().map(|one| format!(" {}: {}", code(&one["const"]), said(one)));
    each.collect()
}

fn referred<'d>(value: &Value, definitions: &'d Definitions) -> Option<&'d Value> {
    definitions.get(value["$ref"].as_str()?.rsplit('/').next()?)
}

fn kind(value: &Value, definitions: &Definitions) -> String {
    if let Some(part) = referred(value, definitions) {
        return match (&part["oneOf"], &part["properties"]) {
            (Value::Array(all), _) => any(all.iter().map(|one| code(&one["const"])), ", "),
            (_, Value::Null) => kind(part, definitions),
            _ => {
                let name = value["$ref"].as_str().unwrap().rsplit('/').next().unwrap();
                format!("[{name}](#{})", name.to_lowercase())
            }
        };
    }
    if let Some(one) = value.get("const") {
        return code(one);
    }
    if let Some(all) = value["anyOf"].as_array() {
        return any(all.iter().map(|one| kind(one, definitions)), " or ");
    }
    match &value["type"] {
        Value::Array(all) => any(all.iter().map(|one| plain(one, value, definitions)), " or "),
        one => plain(one, value, definitions),
    }
}

/// One of the simple types; of lists with what they hold.
fn plain(name: &Value, value: &Value, definitions: &Definitions) -> String {
    let name = name.as_str().unwrap();
    match (name, value["prefixItems"].as_array()) {
        ("array", Some(all)) => {
            format!("[{}]", any(all.iter().map(|one| kind(one, definitions)), ", "))
        }
        ("array", None) => format!("list of {}", kind(&value["items"], definitions)),
        ("string", _) => "text".to_owned(),
        _ => name.to_owned(),
    }
}

fn any(all: impl Iterator<Item = String>, between: &str) -> String {
    all.collect::<Vec<_>>().join(between)
}

fn code(value: &Value) -> String {
    format!("`{value}`")
}
