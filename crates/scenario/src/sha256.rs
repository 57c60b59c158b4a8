//! SHA-256 in hexadecimal.

use std::io::Read;
use std::path::Path;

use sha2::{Digest, Sha256};

use crate::input_file::{InputError, open_input};

/// SHA-256, in hexadecimal, of the contents of a regular file.
///
/// # Errors
/// [`InputError`] for a file that cannot be read.
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let file = folder.path().join("force.csv");
/// std::fs::write(&file, "abc")?;
/// let sha256 = asperity_scenario::file_sha256(&file)?;
/// assert!(sha256.starts_with("ba7816bf"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn file_sha256(path: &Path) -> Result<String, InputError> {
    let mut file = open_input(path, u64::MAX)?;
    let mut hash = Sha256::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        match file.read(&mut buffer)? {
            0 => return Ok(hexadecimal(&hash.finalize())),
            length => hash.update(&buffer[..length]),
        }
    }
}

/// SHA-256, in hexadecimal, of a text.
pub fn text_sha256(text: &str) -> String {
    hexadecimal(&Sha256::digest(text))
}

fn hexadecimal(bytes: &[u8]) -> String {
    let nibbles = bytes.iter().flat_map(|byte| [byte >> 4, byte & 15]);
    nibbles.filter_map(|nibble| char::from_digit(nibble.into(), 16)).collect()
}
