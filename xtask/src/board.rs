//! The board whose parameters are in an EEPROM: QEMU with an AT24C64 backed by
//! a file and a TMP105, and an image on it.

use std::fs::{self, File};
use std::io::{ErrorKind, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use embedded_storage::{ReadStorage, Storage};
use truearm::blob::{Acceptance, Blob};
use truearm::store::{ByteSlots, Store};

use crate::image::image;
use crate::run::{Result, target_dir};

/// Bytes of an AT24C64.
pub const EEPROM: usize = 8192;
const PAGE: usize = 32;
/// Bytes of a slot, as the image has them.
pub const SLOT: u32 = 4096;

/// Of what hangs; an image takes seconds, and a minute on a machine that is busy.
const LIMIT: Duration = Duration::from_secs(600);

/// A board, switched off.
pub struct Board {
    dir: PathBuf,
    robot: u64,
}

/// A board, switched on.
pub struct Running {
    child: Child,
    output: PathBuf,
    /// Closed, it would take what it was told with it.
    monitor: Option<TcpStream>,
}

impl Board {
    /// A board with these bytes in its EEPROM, its files in a directory of this
    /// name.
    pub fn new(name: &str, eeprom: &[u8], robot: u64) -> Result<Self> {
        let dir = target_dir().join("board").join(name);
        fs::create_dir_all(&dir)?;
        let board = Self { dir, robot };
        let mut bytes = eeprom.to_vec();
        bytes.resize(EEPROM, 0xff);
        board.write(&bytes)?;
        Ok(board)
    }

    /// What is in the EEPROM.
    pub fn read(&self) -> Result<Vec<u8>> {
        Ok(fs::read(self.eeprom())?)
    }

    /// What a programmer does.
    pub fn write(&self, bytes: &[u8]) -> Result {
        Ok(fs::write(self.eeprom(), bytes)?)
    }

    fn eeprom(&self) -> PathBuf {
        self.dir.join("eeprom.bin")
    }

    /// Switches it on with the image `store`, a temperature in thousandths of a
    /// degree and perhaps a blob in memory; `verb` is for the image.
    pub fn start(&self, verb: &str, milli_celsius: i32, blob: Option<&Path>) -> Result<Running> {
        let mut more = vec!["-serial".to_owned(), "none".to_owned()];
        if let Some(blob) = blob {
            let blob = escaped(blob);
            let device = format!("loader,file={blob},addr=0x00300000,force-raw=on");
            more.extend(["-device".to_owned(), device]);
        }
        self.launch("store", verb, milli_celsius, &more)
    }

    /// Switches it on with another image, to be talked to over its serial port.
    pub fn start_talking(&self, image: &str) -> Result<(Running, TcpStream)> {
        let listener = TcpListener::bind("127.0.0.1:0")?;
        listener.set_nonblocking(true)?;
        // A delay for each short line would be most of the time.
        let serial = format!("tcp:{},nodelay=on", listener.local_addr()?);
        let mut running = self.launch(image, "boot", 20_000, &["-serial".to_owned(), serial])?;
        let port = running.connected(&listener)?;
        port.set_nonblocking(false)?;
        port.set_nodelay(true)?;
        port.set_read_timeout(Some(LIMIT))?;
        Ok((running, port))
    }

    fn launch(
        &self,
        name: &str,
        verb: &str,
        milli_celsius: i32,
        more: &[String],
    ) -> Result<Running> {
        let output = self.dir.join("output.txt");
        let mut qemu = Command::new("qemu-system-arm");
        qemu.args("-machine mps2-an386 -cpu cortex-m4 -nographic".split(' ')).args(more);
        // Stopped at first: a temperature of the command line is lost at reset.
        let listener = TcpListener::bind("127.0.0.1:0")?;
        listener.set_nonblocking(true)?;
        qemu.args(["-S", "-monitor", &format!("tcp:{}", listener.local_addr()?)]);
        let words = format!("arg={verb},arg={:016x}", self.robot);
        let semihosting = format!("enable=on,target=native,{words}");
        qemu.args(["-semihosting-config", &semihosting]);
        let drive = format!("if=none,id=params,format=raw,file={}", escaped(&self.eeprom()));
        qemu.args(["-drive", &drive, "-device"]);
        // Of the board's buses named i2c the first, the one at 0x4002a000.
        qemu.arg(format!("at24c-eeprom,bus=i2c,address=0x50,rom-size={EEPROM},drive=params"));
        qemu.args(["-device", "tmp105,bus=i2c,address=0x48,id=sensor"]);
        qemu.arg("-kernel").arg(image(name));
        qemu.stdin(Stdio::null()).stdout(File::create(&output)?).stderr(Stdio::inherit());
        let child = qemu.spawn().map_err(|error| format!("qemu-system-arm: {error}"))?;
        let mut running = Running { child, output, monitor: None };
        let mut monitor = running.connected(&listener)?;
        let sensor = "/machine/peripheral/sensor";
        write!(monitor, "qom-set {sensor} temperature {milli_celsius}\ncont\n")?;
        running.monitor = Some(monitor);
        Ok(running)
    }

    /// Runs a verb to its end: whether it went well, and what was printed.
    pub fn run(&self, verb: &str, temperature: i32, blob: Option<&Path>) -> Result<(bool, String)> {
        let mut running = self.start(verb, temperature, blob)?;
        let start = Instant::now();
        loop {
            if let Some(status) = running.child.try_wait()? {
                return Ok((status.success(), fs::read_to_string(&running.output)?));
            }
            if start.elapsed() > LIMIT {
                running.cut()?;
                return Err(format!("the image did not end within {} s", LIMIT.as_secs()).into());
            }
            thread::sleep(Duration::from_millis(10));
        }
    }

    /// What the image's code finds in the EEPROM as it is now, on a copy.
    pub fn found(&self) -> Result<Option<Vec<u8>>> {
        let slots = ByteSlots::<_, PAGE>::new(Copied(self.read()?), [0, SLOT], SLOT)?;
        let mut buffer = vec![0; SLOT as usize];
        let (store, opened) = Store::open(slots, &mut buffer, Acceptance::of(self.robot, 6))?;
        let size = opened.blob.map(|blob| blob.size());
        let Some((slot, _)) = store.live() else { return Ok(None) };
        let Copied(bytes) = store.release().release();
        let start = if slot == truearm::store::Slot::A { 0 } else { SLOT as usize };
        let blob = &bytes[start..][..size.unwrap_or(0)];
        Blob::check(blob)?;
        Ok(Some(blob.to_vec()))
    }
}

impl Running {
    /// QEMU's monitor, as soon as it calls.
    fn connected(&mut self, listener: &TcpListener) -> Result<TcpStream> {
        let start = Instant::now();
        loop {
            match listener.accept() {
                Ok((stream, _)) => return Ok(stream),
                Err(error) if error.kind() != ErrorKind::WouldBlock => return Err(error.into()),
                Err(_) => (),
            }
            if let Some(status) = self.child.try_wait()? {
                return Err(format!("QEMU did not start: {status}").into());
            }
            if start.elapsed() > LIMIT {
                self.child.kill()?;
                self.child.wait()?;
                return Err("QEMU did not open its monitor".into());
            }
            thread::sleep(Duration::from_millis(2));
        }
    }

    /// Until the image has printed this text so often.
    pub fn wait_for(&mut self, text: &str, times: usize) -> Result {
        let start = Instant::now();
        while fs::read_to_string(&self.output)?.matches(text).count() < times {
            if start.elapsed() > LIMIT || self.child.try_wait()?.is_some() {
                return Err(format!("the image does not say `{text}`").into());
            }
            thread::sleep(Duration::from_millis(1));
        }
        Ok(())
    }

    /// Ends the power.
    pub fn kill(&mut self) -> Result {
        self.child.kill()?;
        self.child.wait()?;
        Ok(())
    }

    /// The same; what was printed until then.
    pub fn cut(mut self) -> Result<String> {
        self.kill()?;
        Ok(fs::read_to_string(&self.output)?)
    }
}

impl Drop for Running {
    /// Whatever went wrong: no board stays on.
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A lone comma would end the name.
fn escaped(path: &Path) -> String {
    path.display().to_string().replace(',', ",,")
}

/// A file's bytes as an EEPROM.
struct Copied(Vec<u8>);

impl ReadStorage for Copied {
    type Error = ();

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> std::result::Result<(), ()> {
        let range = offset as usize..offset as usize + bytes.len();
        bytes.copy_from_slice(self.0.get(range).ok_or(())?);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.len()
    }
}

impl Storage for Copied {
    fn write(&mut self, offset: u32, bytes: &[u8]) -> std::result::Result<(), ()> {
        let range = offset as usize..offset as usize + bytes.len();
        self.0.get_mut(range).ok_or(())?.copy_from_slice(bytes);
        Ok(())
    }
}
