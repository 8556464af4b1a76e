//! The page as a document: sections of text and figures.

use super::BEGIN;
use crate::markup::{Element, Node, element};
use crate::plot::{Panel, STYLE, grid};

/// Panels that are wider stand alone.
const WIDE: f64 = 600.0;
/// Colours and columns of the page.
const PAGE_STYLE: &str = include_str!("page.css");
/// The view that can be turned.
const VIEW: &str = include_str!("view.js");

/// A figure: panels that belong together.
#[derive(Debug, Clone)]
pub struct Figure {
    /// Name of its file, without the ending.
    pub name: String,
    /// What it shows and how to read it.
    pub caption: String,
    /// What is drawn.
    pub panels: Vec<Panel>,
}

impl Figure {
    /// Of panels.
    pub fn new(name: impl Into<String>, caption: impl Into<String>, panels: Vec<Panel>) -> Self {
        Self { name: name.into(), caption: caption.into(), panels }
    }

    /// As a file of its own.
    #[must_use]
    pub fn svg(&self) -> String {
        grid(&self.panels, 2)
    }

    fn drawn(&self) -> Element {
        let panel = |panel: &Panel| {
            let class = if panel.size.0 < WIDE { "panel" } else { "panel wide" };
            let drawn = element("div").with("class", class);
            drawn.child(element("h3").text(&panel.title)).child(panel.drawn())
        };
        let count = self.panels.len().min(3);
        let panels = element("div").with("class", format!("panels of{count}"));
        element("figure")
            .with("id", format!("figure-{}", self.name))
            .child(panels.children(self.panels.iter().map(panel)))
            .child(element("figcaption").text(&self.caption))
    }
}

/// What a section holds.
#[derive(Debug, Clone)]
pub enum Part {
    /// Text.
    Text(Node),
    /// A figure.
    Figure(Figure),
}

impl Part {
    /// A figure of one panel of the usual size.
    fn is_small(&self) -> bool {
        match self {
            Self::Figure(figure) => figure.panels.len() == 1 && figure.panels[0].size.0 < WIDE,
            Self::Text(_) => false,
        }
    }
}

/// A section of a page.
#[derive(Debug, Clone)]
pub struct Section {
    id: &'static str,
    heading: String,
    parts: Vec<Part>,
}

impl Section {
    /// An empty one.
    pub fn new(id: &'static str, heading: impl Into<String>) -> Self {
        Self { id, heading: heading.into(), parts: Vec::new() }
    }

    /// With a paragraph.
    #[must_use]
    pub fn say(self, text: impl Into<String>) -> Self {
        self.node(element("p").text(text.into()))
    }

    /// With markup.
    #[must_use]
    pub fn node(mut self, node: impl Into<Node>) -> Self {
        self.parts.push(Part::Text(node.into()));
        self
    }

    /// With a figure.
    #[must_use]
    pub fn figure(mut self, figure: Figure) -> Self {
        self.parts.push(Part::Figure(figure));
        self
    }

    /// With all of these.
    #[must_use]
    pub fn figures(self, figures: impl IntoIterator<Item = Figure>) -> Self {
        figures.into_iter().fold(self, Self::figure)
    }

    fn drawn(&self) -> Element {
        let part = |part: &Part| match part {
            Part::Text(node) => node.clone(),
            Part::Figure(figure) => figure.drawn().into(),
        };
        let mut section = element("section").with("id", self.id);
        section = section.child(element("h2").text(&self.heading));
        for run in self.parts.chunk_by(|a, b| a.is_small() && b.is_small()) {
            section = match run {
                // Figures side by side, as many as there is room for.
                [first, ..] if first.is_small() => {
                    let gallery = element("div").with("class", "gallery");
                    section.child(gallery.children(run.iter().map(part)))
                }
                _ => section.children(run.iter().map(part)),
            };
        }
        section
    }
}

/// A page.
#[derive(Debug, Clone)]
pub struct Page {
    /// What was asked, and of which arm.
    pub title: String,
    /// The verdict in one sentence.
    pub verdict: String,
    /// `good`, `doubt`, `bad` or `plain`: how the verdict looks.
    pub mood: &'static str,
    /// Figures beside the verdict: what, how much.
    pub numbers: Vec<(String, String)>,
    /// The rest.
    pub sections: Vec<Section>,
}

impl Page {
    /// All figures, in the order of the page.
    pub fn figures(&self) -> impl Iterator<Item = &Figure> {
        self.sections.iter().flat_map(|s| &s.parts).filter_map(|part| match part {
            Part::Figure(figure) => Some(figure),
            Part::Text(_) => None,
        })
    }

    /// The file.
    #[must_use]
    pub fn html(&self) -> String {
        let root = element("html").with("lang", "en").with("xmlns", "http://www.w3.org/1999/xhtml");
        format!("{BEGIN}{}\n", root.child(self.head()).child(self.body()))
    }

    fn head(&self) -> Element {
        let meta =
            |name: &str, content: &str| element("meta").with("name", name).with("content", content);
        // Nothing is fetched, whatever a name in a file says.
        let policy = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'";
        element("head")
            .child(element("meta").with("charset", "utf-8"))
            .child(
                element("meta")
                    .with("http-equiv", "Content-Security-Policy")
                    .with("content", policy),
            )
            .child(meta("viewport", "width=device-width, initial-scale=1"))
            .child(meta("color-scheme", "light dark"))
            .child(element("title").text(&self.title))
            .child(element("style").child(Node::Code(PAGE_STYLE)).child(Node::Code(STYLE)))
    }

    fn body(&self) -> Element {
        let number = |(what, much): &(String, String)| {
            let tile = element("div");
            tile.child(element("dt").text(what)).child(element("dd").text(much))
        };
        let numbers = element("dl").with("class", "numbers");
        let header = element("header")
            .child(element("h1").text(&self.title))
            .child(element("p").with("class", format!("verdict {}", self.mood)).text(&self.verdict))
            .child(numbers.children(self.numbers.iter().map(number)));
        let link = |s: &Section| element("a").with("href", format!("#{}", s.id)).text(&s.heading);
        let contents = element("nav").with("aria-label", "Contents");
        let made = format!("truearm {}", env!("CARGO_PKG_VERSION"));
        let main = element("main")
            .child(header)
            .child(contents.children(self.sections.iter().map(link)))
            .children(self.sections.iter().map(Section::drawn));
        element("body")
            .child(main)
            .child(element("footer").text(format!("Written by {made}.")))
            .child(element("script").child(Node::Code(VIEW)))
    }
}
