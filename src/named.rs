//! The files that a model names: tables, and files of components. Reads them only below certain folders, and no more of
//! them than allowed. The program and the Python package are built with it. See docs/cli.md#streams-and-exit-status.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use vibc::{FileId, SourceFile, SourceKind, Sources, limits};

/// Reads every file that the model at `path` names, below the model's own folder and below `root`. A file that cannot
/// be read is reported at its place in the model; `outside` is the reason given for a file in any other folder.
pub fn add_named(sources: &mut Sources, model: FileId, path: &Path, root: Option<&Path>, outside: &'static str) {
    let folder = sources.file(model).directory.clone();
    let folders: Vec<PathBuf> = std::iter::once(folder).chain(root.map(Path::to_path_buf)).collect();
    let mut components = Named::components(folders.clone(), outside);
    vibc::add_used_files(sources, model, key_of(path), |name| components.read_keyed(Path::new(name)));
    read_tables(sources, Named::tables(folders, outside));
}

/// An identity of a file that does not depend on the path to it.
pub fn key_of(path: &Path) -> Option<String> {
    fs::canonicalize(path).ok().map(|path| path.to_string_lossy().into_owned())
}

/// Files of tables of all files of a model: a run has room for 256 files.
const MOST_TABLES: usize = 200;

/// Reads the tables that a model and the files that it uses name. A table that cannot be read is reported at its place
/// in the model.
fn read_tables(sources: &mut Sources, mut tables: Named) {
    let files: Vec<FileId> = sources.models().collect();
    let named: Vec<String> = files
        .into_iter()
        .flat_map(|file| vibc::table_files(sources, file).into_iter().map(move |written| (file, written)))
        .map(|(file, written)| sources.file(file).relative_name(&written))
        .take(MOST_TABLES)
        .collect();
    for name in named {
        let file = match tables.read(Path::new(&name)) {
            Ok(bytes) => SourceFile::decode(SourceKind::Table, name, bytes),
            Err(reason) => SourceFile::unread(SourceKind::Table, name, reason),
        };
        sources.add(file);
    }
}

/// Files that a model names: tables, and files of components. A model may come from a stranger, so they are read only
/// below certain folders, and no more of them than allowed.
pub struct Named {
    /// `""` is the folder that the program was started in.
    folders: Vec<PathBuf>,
    /// The reason given for a file in any other folder.
    outside: &'static str,
    /// Bytes that may still be read.
    room: usize,
    /// The message if the limit is reached.
    full: String,
}

impl Named {
    pub fn tables(folders: Vec<PathBuf>, outside: &'static str) -> Named {
        let full = format!("the tables of a model have at most {} MiB in total", limits::TABLES >> 20);
        Named { folders, outside, room: limits::TABLES, full }
    }

    pub fn components(folders: Vec<PathBuf>, outside: &'static str) -> Named {
        let full = format!("the files that a model uses have at most {} MiB in total", limits::USED >> 20);
        Named { folders, outside, room: limits::USED, full }
    }

    /// The key that identifies the file, and its content.
    pub fn read_keyed(&mut self, path: &Path) -> Result<(String, Vec<u8>), String> {
        let bytes = self.read(path)?;
        let key = key_of(path).ok_or("it is gone")?;
        Ok((key, bytes))
    }

    /// Reads a regular file. Links count as their targets.
    pub fn read(&mut self, path: &Path) -> Result<Vec<u8>, String> {
        let reported = |error: io::Error| error.to_string();
        let path = fs::canonicalize(path).map_err(reported)?;
        if !self.folders.iter().any(|folder| is_below(&path, folder)) {
            return Err(self.outside.into());
        }
        let mut bytes = Vec::new();
        open_regular(&path).map_err(reported)?.take(self.room as u64 + 1).read_to_end(&mut bytes).map_err(reported)?;
        self.room = self.room.checked_sub(bytes.len()).ok_or_else(|| self.full.clone())?;
        Ok(bytes)
    }
}

/// Opens a regular file to read it; a pipe or a device may have no end, or block for ever.
pub fn open_regular(path: &Path) -> io::Result<File> {
    match fs::metadata(path)?.is_file() {
        true => File::open(path),
        false => Err(io::Error::other("it is not a regular file")),
    }
}

fn is_below(path: &Path, folder: &Path) -> bool {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    fs::canonicalize(folder).is_ok_and(|folder| path.starts_with(folder))
}

/// Reads up to one byte more than a model may have, which is enough to refuse it.
pub fn read_limited(from: impl Read) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    from.take(limits::FILE as u64 + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}
