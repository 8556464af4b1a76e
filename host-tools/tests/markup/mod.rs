//! A page taken apart, as a reader of XML sees it.

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

/// An element.
#[derive(Debug, Default)]
pub struct Element {
    pub name: String,
    pub attributes: Vec<(String, String)>,
    pub children: Vec<Element>,
    pub text: String,
}

impl Element {
    /// Of a document; panics where it is not well-formed.
    pub fn parse(text: &str) -> Self {
        let mut reader = Reader::from_str(text);
        let mut open = vec![Self::default()];
        loop {
            match reader
                .read_event()
                .unwrap_or_else(|e| panic!("{e} at {}", reader.error_position()))
            {
                Event::Start(start) => open.push(Self::of(&start)),
                Event::Empty(start) => open.last_mut().unwrap().children.push(Self::of(&start)),
                Event::End(_) => {
                    let done = open.pop().unwrap();
                    open.last_mut().expect("more ends than starts").children.push(done);
                }
                Event::Text(text) => {
                    let text = text.decode().unwrap();
                    assert!(!text.contains('<'), "{text}");
                    open.last_mut().unwrap().text += &text;
                }
                Event::CData(text) => open.last_mut().unwrap().text += &text.decode().unwrap(),
                Event::GeneralRef(entity) => {
                    let name = entity.decode().unwrap();
                    let known = match &*name {
                        "amp" => "&",
                        "lt" => "<",
                        "gt" => ">",
                        "quot" => "\"",
                        "#39" => "'",
                        other => panic!("&{other};"),
                    };
                    open.last_mut().unwrap().text += known;
                }
                Event::Eof => break,
                _ => {}
            }
        }
        assert_eq!(open.len(), 1, "{} is not closed", open.last().unwrap().name);
        open.pop().unwrap()
    }

    fn of(start: &BytesStart) -> Self {
        let attribute = |a: Result<quick_xml::events::attributes::Attribute, _>| {
            let a = a.unwrap();
            let value = a.unescape_value().unwrap().into_owned();
            (String::from_utf8(a.key.as_ref().to_vec()).unwrap(), value)
        };
        Self {
            name: String::from_utf8(start.name().as_ref().to_vec()).unwrap(),
            attributes: start.attributes().map(attribute).collect(),
            ..Self::default()
        }
    }

    pub fn get(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|a| a.0 == name).map(|a| a.1.as_str())
    }

    /// All elements of a name, this one's children and theirs.
    pub fn all(&self, name: &str) -> Vec<&Self> {
        let mut out = Vec::new();
        for child in &self.children {
            if child.name == name {
                out.push(child);
            }
            out.extend(child.all(name));
        }
        out
    }

    /// The element with this id.
    pub fn id(&self, id: &str) -> Option<&Self> {
        let own = self.children.iter().find(|c| c.get("id") == Some(id));
        own.or_else(|| self.children.iter().find_map(|c| c.id(id)))
    }

    /// Marks of a drawn series: what it says it has, and what is drawn.
    pub fn marks(&self) -> (usize, usize) {
        let said = self.get("data-marks").unwrap().parse().unwrap();
        let of = |class: &str| {
            let own = |e: &&&Self| e.get("class").is_some_and(|c| c.split(' ').any(|c| c == class));
            [self.all("path"), self.all("rect")]
                .concat()
                .iter()
                .filter(own)
                .copied()
                .collect::<Vec<_>>()
        };
        let pens =
            |e: &Self, pen: &str| e.get("d").unwrap().matches(pen.chars().next().unwrap()).count();
        let shapes = of("shape").len() + of("tread").len() + of("bar").len();
        let dots: usize = of("dots").iter().map(|e| pens(e, "M")).sum();
        let lines: usize = of("line").iter().map(|e| pens(e, "M") + pens(e, "L")).sum();
        // There and back.
        let bands: usize = of("band").iter().map(|e| (pens(e, "M") + pens(e, "L")) / 2).sum();
        let arrows = if shapes == 0 { of("thin").iter().map(|e| pens(e, "M")).sum() } else { 0 };
        (said, shapes + dots + lines + bands + arrows)
    }
}
