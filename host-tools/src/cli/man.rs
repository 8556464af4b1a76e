use std::path::{Path, PathBuf};

use clap::{Args, Command};
use clap_mangen::Man;
use truearm_host::files::write;
use truearm_host::{Error, Result};

use super::Said;

/// Write manual pages, one a verb, into a folder.
#[derive(Args)]
pub struct Manual {
    /// The folder, such as ~/.local/share/man/man1
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

impl Manual {
    pub fn run(self, mut program: Command) -> Result<Said> {
        program.build();
        let name = program.get_name().to_owned();
        let mut count = 1;
        for verb in program.get_subcommands().filter(|verb| verb.get_name() != "help") {
            let page = format!("{name}-{}", verb.get_name());
            self.page(verb.clone(), &page)?;
            count += 1;
        }
        self.page(program, &name)?;
        Ok(format!("wrote {count} pages to {}\n", self.folder.display()).into())
    }

    fn page(&self, command: Command, name: &str) -> Result<()> {
        let path: &Path = &self.folder.join(format!("{name}.1"));
        let mut text = Vec::new();
        Man::new(command).title(name).render(&mut text).map_err(|e| Error::io(path, e))?;
        write(path, &text)
    }
}
