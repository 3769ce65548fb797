//! Pages under `docs/results`.

use std::{fs, io, path::Path};

/// The heading of the last section, which people write.
const READING: &str = "\n## Reading\n";

/// Writes the page of that name; its section `## Reading` stays as it is.
pub(crate) fn save(name: &str, text: &str) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/results");
    let path = folder.join(name);
    match fs::create_dir_all(&folder).and_then(|()| write(&path, text)) {
        Ok(()) => println!("\nwritten to docs/results/{name}"),
        Err(error) => eprintln!("cannot write {}: {error}", path.display()),
    }
}

fn write(path: &Path, text: &str) -> io::Result<()> {
    let known = match fs::read_to_string(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => String::new(),
        known => known?,
    };
    let reading = known.find(READING).map_or("", |start| &known[start..]);
    fs::write(path, format!("{}\n{reading}", text.trim_end()))
}
