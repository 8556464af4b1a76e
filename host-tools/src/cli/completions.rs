use clap::{Args, Command};
use clap_complete::{Shell, generate};
use truearm_host::Result;

use super::Said;

/// Print completions for a shell: truearm completions bash > /etc/bash_completion.d/truearm
#[derive(Args)]
pub struct Completions {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

impl Completions {
    pub fn run(self, mut program: Command) -> Result<Said> {
        let mut text = Vec::new();
        generate(self.shell, &mut program, "truearm", &mut text);
        Ok(Said::asked(String::from_utf8_lossy(&text).into_owned()))
    }
}
