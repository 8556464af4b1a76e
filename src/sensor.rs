//! Temperature for [`crate::State::temperature`], which thermal-expansion
//! terms depend on.

use embedded_hal::i2c::I2c;

/// Address of a TMP105 or LM75 whose address pins are low.
pub const TEMPERATURE_SENSOR: u8 = 0x48;

const TEMPERATURE: u8 = 0;

/// Reads a temperature sensor of the LM75 family (LM75, TMP75, TMP102, TMP105,
/// PCT2075...), degrees Celsius, -128 to 127.99: register 0 holds it as a
/// signed big-endian number of 1/256 degree, of which a part fills in the upper
/// 9 to 12 bits, as it was set up.
/// Until the first conversion after power-up is done, about 0.1 s, such sensors answer with
/// whatever their register begins with, many with 0: wait, or [`ThermalLag`](crate::ThermalLag)
/// begins with an arm that is as cold.
///
/// # Errors
/// When the bus fails or nobody answers at the address.
///
/// ```
/// use embedded_hal_mock::eh1::i2c::{Mock, Transaction};
/// use truearm::sensor::{TEMPERATURE_SENSOR, read_temperature};
///
/// let answer = Transaction::write_read(TEMPERATURE_SENSOR, vec![0], vec![0x17, 0x80]);
/// let mut bus = Mock::new(&[answer]);
/// assert_eq!(read_temperature(&mut bus, TEMPERATURE_SENSOR), Ok(23.5));
/// bus.done();
/// ```
pub fn read_temperature<I: I2c>(bus: &mut I, address: u8) -> Result<f32, I::Error> {
    let mut bytes = [0; 2];
    bus.write_read(address, &[TEMPERATURE], &mut bytes)?;
    Ok(f32::from(i16::from_be_bytes(bytes)) / 256.0)
}
