//! `deltarobot-headers DIRECTORY` writes the C headers into a directory like `include/`; those that are as they should be
//! are left alone. Run at the root of the source tree, by `make header`.

use std::error::Error;
use std::fs;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let directory = std::env::args().nth(1).ok_or("usage: deltarobot-headers DIRECTORY")?;
    let work = Path::new("target/headers");
    fs::create_dir_all(work)?;
    for (path, text) in deltarobot_headers::headers(Path::new("."), work)? {
        let path = Path::new(&directory).join(path);
        if !fs::read(&path).is_ok_and(|old| old == text.as_bytes()) {
            fs::write(path, text)?;
        }
    }
    Ok(())
}
