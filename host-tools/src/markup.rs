//! Markup as a tree: whatever a user wrote becomes text or the value of an
//! attribute, never a tag. What is written is HTML and well-formed XML alike.

use std::fmt::{self, Display, Write};

/// An element or a text.
#[derive(Debug, Clone, PartialEq)]
pub enum Node {
    /// An element.
    Element(Element),
    /// Text, escaped when written.
    Text(String),
    /// A script or a style sheet of truearm's own, written as it stands.
    Code(&'static str),
}

/// An element with its attributes and what stands in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    name: &'static str,
    attributes: Vec<(&'static str, String)>,
    children: Vec<Node>,
}

/// Elements of HTML that never have an end tag.
const VOID: [&str; 6] = ["meta", "br", "hr", "input", "link", "col"];
/// Elements of SVG that have none where they are empty.
const SHAPES: [&str; 5] = ["path", "rect", "line", "circle", "stop"];

/// An empty element.
#[must_use]
pub fn element(name: &'static str) -> Element {
    Element { name, attributes: Vec::new(), children: Vec::new() }
}

impl Element {
    /// With an attribute.
    #[must_use]
    pub fn with(mut self, name: &'static str, value: impl Display) -> Self {
        self.attributes.push((name, value.to_string()));
        self
    }

    /// With one more child.
    #[must_use]
    pub fn child(mut self, child: impl Into<Node>) -> Self {
        self.children.push(child.into());
        self
    }

    /// With more children.
    #[must_use]
    pub fn children<N: Into<Node>>(mut self, children: impl IntoIterator<Item = N>) -> Self {
        self.children.extend(children.into_iter().map(Into::into));
        self
    }

    /// With text at its end.
    #[must_use]
    pub fn text(self, text: impl Display) -> Self {
        self.child(Node::Text(text.to_string()))
    }
}

impl From<Element> for Node {
    fn from(element: Element) -> Self {
        Self::Element(element)
    }
}

impl From<&str> for Node {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Node {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl Display for Node {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Element(element) => element.fmt(f),
            Self::Text(text) => escaped(text, f),
            // For readers of XML a section in which nothing is a tag; for those of
            // HTML its marks are comments.
            Self::Code(code) => write!(f, "/*<![CDATA[*/\n{code}/*]]>*/"),
        }
    }
}

impl Display for Element {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "<{}", self.name)?;
        for (name, value) in &self.attributes {
            write!(f, " {name}=\"")?;
            escaped(value, f)?;
            f.write_char('"')?;
        }
        let shut = VOID.contains(&self.name) || SHAPES.contains(&self.name);
        if shut && self.children.is_empty() {
            return f.write_str("/>");
        }
        f.write_char('>')?;
        self.children.iter().try_for_each(|child| child.fmt(f))?;
        write!(f, "</{}>", self.name)
    }
}

/// Characters that markup gives a meaning to, or has no place for, are none.
fn escaped(text: &str, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    for c in text.chars() {
        match c {
            '&' => f.write_str("&amp;")?,
            '<' => f.write_str("&lt;")?,
            '>' => f.write_str("&gt;")?,
            '"' => f.write_str("&quot;")?,
            '\'' => f.write_str("&#39;")?,
            '\n' | '\t' => f.write_char(c)?,
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => {
                f.write_char(char::REPLACEMENT_CHARACTER)?;
            }
            c => f.write_char(c)?,
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_users_write_is_text() {
        let name = "<script>alert(\"1\")</script> & 'co' \u{1b}[0m";
        let node = element("p").with("title", name).text(name).to_string();
        let text =
            "&lt;script&gt;alert(&quot;1&quot;)&lt;/script&gt; &amp; &#39;co&#39; \u{fffd}[0m";
        assert_eq!(node, format!("<p title=\"{text}\">{text}</p>"));
    }

    #[test]
    fn only_some_elements_have_no_end_tag() {
        let page = element("div").child(element("br")).child(element("p")).child(element("path"));
        assert_eq!(page.to_string(), "<div><br/><p></p><path/></div>");
    }
}
