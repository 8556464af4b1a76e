use std::path::PathBuf;

use clap::{Args, Command};
use clap_mangen::Man;
use truearm_host::files::write;
use truearm_host::{Error, Result};

use super::{Said, markdown};

/// Write manual pages, one a verb, into a folder.
#[derive(Args)]
pub struct Manual {
    /// The folder, such as ~/.local/share/man/man1
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Write the pages of docs/verbs, in Markdown, instead
    #[arg(long)]
    markdown: bool,
}

impl Manual {
    pub fn run(self, mut program: Command) -> Result<Said> {
        program.build();
        let verbs: Vec<&Command> = markdown::verbs(&program).collect();
        for verb in &verbs {
            self.page(verb)?;
        }
        self.page(&program)?;
        Ok(format!("wrote {} pages to {}\n", verbs.len() + 1, self.folder.display()).into())
    }

    fn page(&self, command: &Command) -> Result<()> {
        let is_program = command.get_bin_name().is_none_or(|name| !name.contains(' '));
        if self.markdown {
            let text =
                if is_program { markdown::of_program(command) } else { markdown::of_verb(command) };
            let path = self.folder.join(format!("{}.md", command.get_name()));
            return write(&path, text.as_bytes());
        }
        let name = command.get_bin_name().unwrap_or(command.get_name()).replace(' ', "-");
        let path = self.folder.join(format!("{name}.1"));
        let mut text = Vec::new();
        let made = Man::new(command.clone()).title(name).render(&mut text);
        made.map_err(|e| Error::io(&path, e))?;
        write(&path, &text)
    }
}
