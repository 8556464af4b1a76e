use super::super::document::Section;
use super::folded;
use crate::identify::Figures;

/// What the data cannot tell, in words.
pub fn unknown(f: &Figures, not_testable: &[String]) -> Section {
    let mut section = Section::new("unknown", "What the data cannot tell");
    if f.unidentifiable.is_empty() && f.weakly_determined.is_empty() && not_testable.is_empty() {
        return section.say("Every parameter is determined by these rows.");
    }
    if !f.unidentifiable.is_empty() {
        section = section
            .say(
                "No measured value depends on these combinations; they stay as the drawing has them. \
                 Where points were measured no place of that target depends on them either; where \
                 lengths, levels, touches or images were, the place of the tool may:",
            )
            .node(folded(&f.unidentifiable, "combinations of parameters"));
    }
    if !f.weakly_determined.is_empty() {
        section = section
            .say(
                "Of these the rows alone say less than the manufacturing tolerances; with the \
                 tolerances, as the intervals of the corrections have them, they are known better:",
            )
            .node(folded(&f.weakly_determined, "combinations of parameters"));
    }
    if !not_testable.is_empty() {
        section = section
            .say("These effects could not be tested for want of something in the files:")
            .node(folded(not_testable, "effects"));
    }
    section
}
