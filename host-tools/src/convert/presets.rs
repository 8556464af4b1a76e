//! Nominal arms of published data sheets, each a robot.toml with its source.

/// A preset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Preset {
    /// As it is asked for.
    pub name: &'static str,
    /// The text of its robot.toml.
    pub text: &'static str,
}

impl Preset {
    /// The arm's full name: the first line of the file.
    #[must_use]
    pub fn title(&self) -> &'static str {
        self.text.lines().next().unwrap_or_default().trim_start_matches(['#', ' '])
    }

    /// Where its numbers are published: the second line.
    #[must_use]
    pub fn source(&self) -> &'static str {
        let line = self.text.lines().nth(1).unwrap_or_default();
        line.trim_start_matches(['#', ' ']).trim_start_matches("Source: ")
    }

    /// By its name; capitals, blanks, `-` and `_` do not count.
    #[must_use]
    pub fn find(name: &str) -> Option<Self> {
        let plain = |name: &str| name.to_lowercase().replace(['-', '_', ' '], "");
        PRESETS.into_iter().find(|preset| plain(preset.name) == plain(name))
    }
}

macro_rules! presets {
    ($($name:literal),* $(,)?) => {
        /// All of them.
        pub const PRESETS: [Preset; [$($name),*].len()] = [$(Preset {
            name: $name,
            text: include_str!(concat!("../../presets/", $name, ".toml")),
        }),*];
    };
}

presets![
    "ur3",
    "ur5",
    "ur10",
    "ur3e",
    "ur5e",
    "ur10e",
    "ur16e",
    "ur20",
    "ur30",
    "panda",
    "fr3",
    "lbr-iiwa-7-r800",
    "lbr-iiwa-14-r820",
    "kr-6-r900",
    "irb-120",
    "puma-560",
    "gen3",
    "xarm6",
    "xarm7",
];
