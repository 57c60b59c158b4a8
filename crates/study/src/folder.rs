//! The folder of a study: a manifest, and chunks of the results that are whole or absent.
//!
//! ```text
//! out/rig/study.json            manifest: what the results follow from, rows and chunks
//! out/rig/chunks/00000012.csv   rows of chunk 12, after a line that names study and chunk
//! out/rig/study.csv             all rows, once all chunks are there
//! out/rig/study.parquet         the same rows
//! ```
//!
//! Each file is written under another name, brought to the disk, and renamed. The bytes of a chunk
//! follow from its number, so that two runs which write the same chunk do no harm: no lock is needed,
//! on no file system.

mod parquet_table;

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, BufWriter, Read, Write};
use std::path::{Path, PathBuf};

use asperity_table::{CsvWriter, DataTable};
use serde_json::{Value, json};

use crate::error::StudyError;
use crate::plan::StudyPlan;
use crate::study_table::StudyTable;
use parquet_table::ParquetTable;
pub(crate) use parquet_table::Role;

/// Schema of the manifest.
const SCHEMA: &str = "asperity/study-run/1";

/// Names in the folder.
const MANIFEST: &str = "study.json";
const CHUNKS: &str = "chunks";
const TABLE: &str = "study.csv";
const PARQUET: &str = "study.parquet";

/// First characters of the name of a file that is being written.
const BEGUN: &str = ".new-";

/// First words of a chunk.
const CHUNK_MARK: &str = "# asperity study chunk";

/// The folder of one study.
#[derive(Debug, Clone)]
pub struct StudyFolder {
    path: PathBuf,
    manifest: Value,
}

impl StudyFolder {
    /// Begins or continues the study of `identity` in `folder`.
    ///
    /// # Errors
    /// [`StudyError::Foreign`] for a folder with other files or another study,
    /// [`StudyError::Begun`] for one that holds chunks unless `resume` is set, and
    /// [`StudyError::Io`].
    pub(crate) fn claim(
        folder: &Path,
        identity: &Value,
        [rows, chunk_rows]: [u64; 2],
        columns: &[(String, Role)],
        resume: bool,
    ) -> Result<Self, StudyError> {
        let describe = |(name, role): &(String, Role)| json!({ "name": name, "role": role.key() });
        let manifest = json!({
            "schema": SCHEMA,
            "identity": identity,
            "rows": rows,
            "chunk_rows": chunk_rows,
            "columns": columns.iter().map(describe).collect::<Vec<_>>(),
        });
        let new = Self { path: folder.to_owned(), manifest };
        if let Some(found) = Self::read(folder)? {
            new.check_same(&found)?;
            let chunks = new.chunks();
            let done = if new.is_complete() { chunks } else { new.chunk_numbers()?.len() as u64 };
            if !resume && done > 0 {
                return Err(StudyError::Begun { folder: new.path, done, chunks });
            }
        } else {
            fs::create_dir_all(folder).map_err(new.fail(""))?;
            let mut entries = fs::read_dir(folder).map_err(new.fail(""))?;
            if let Some(entry) = entries.find(|entry| !entry.as_ref().is_ok_and(is_ours)) {
                let name = entry.map_err(new.fail(""))?.file_name();
                let found = format!("`{}`, which is no part of a study", name.to_string_lossy());
                return Err(StudyError::Foreign { folder: new.path, found });
            }
            write_whole(&new.path.join(MANIFEST), |file| writeln!(file, "{:#}", new.manifest))
                .map_err(new.fail(MANIFEST))?;
            // Another shard may have begun at the same time.
            new.check_same(&Self::open(folder)?)?;
        }
        fs::create_dir_all(new.path.join(CHUNKS)).map_err(new.fail(CHUNKS))?;
        Ok(new)
    }

    /// The study in `folder`.
    ///
    /// # Errors
    /// [`StudyError::Foreign`] for a folder without a study, [`StudyError::Io`].
    pub fn open(folder: &Path) -> Result<Self, StudyError> {
        Self::read(folder)?.ok_or_else(|| StudyError::Foreign {
            folder: folder.to_owned(),
            found: "no study".into(),
        })
    }

    fn read(folder: &Path) -> Result<Option<Self>, StudyError> {
        let path = folder.join(MANIFEST);
        let text = match fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(StudyError::Io { path, source }),
        };
        let manifest: Value = serde_json::from_str(&text).unwrap_or_default();
        if manifest["schema"] != SCHEMA {
            let found = format!("a file {MANIFEST} of another kind");
            return Err(StudyError::Foreign { folder: folder.to_owned(), found });
        }
        Ok(Some(Self { path: folder.to_owned(), manifest }))
    }

    /// Names the first part in which another study differs.
    fn check_same(&self, found: &Self) -> Result<(), StudyError> {
        let parts = [
            ("/identity/version", "the results of another version of asperity"),
            ("/identity/results", "results of another version of asperity"),
            ("/identity/scenario_sha256", "the study of another scenario, or of a changed one"),
            ("/identity/study_sha256", "the study of other inputs, or of another design"),
            ("/identity/draws_sha256", "a study with other draws"),
            ("/identity/table_sha256", "a study with another table of rows"),
            ("", "another study"),
        ];
        let differs = |(pointer, _): &&(&str, &str)| {
            self.manifest.pointer(pointer) != found.manifest.pointer(pointer)
        };
        match parts.iter().find(differs) {
            None => Ok(()),
            Some((_, words)) => {
                Err(StudyError::Foreign { folder: self.path.clone(), found: (*words).to_owned() })
            }
        }
    }

    /// The folder's path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Number of rows of the study.
    pub fn rows(&self) -> u64 {
        self.manifest["rows"].as_u64().unwrap_or_default()
    }

    /// Number of chunks of the study.
    pub fn chunks(&self) -> u64 {
        self.rows().div_ceil(self.chunk_rows())
    }

    fn chunk_rows(&self) -> u64 {
        self.manifest["chunk_rows"].as_u64().unwrap_or(1).max(1)
    }

    /// Rows of a chunk.
    pub(crate) fn rows_of(&self, chunk: u64) -> std::ops::Range<u64> {
        chunk * self.chunk_rows()..((chunk + 1) * self.chunk_rows()).min(self.rows())
    }

    /// Names of the columns with their parts in the study.
    fn columns(&self) -> Vec<(String, Role)> {
        let column = |one: &Value| {
            let name = one["name"].as_str()?.to_owned();
            let role = Role::ALL.into_iter().find(|role| one["role"] == role.key())?;
            Some((name, role))
        };
        self.manifest["columns"].as_array().into_iter().flatten().filter_map(column).collect()
    }

    /// Checks that the folder holds the study of a plan.
    ///
    /// # Errors
    /// [`StudyError::Foreign`] if it is another one.
    pub(crate) fn check_plan(&self, plan: &StudyPlan) -> Result<(), StudyError> {
        let mut manifest = self.manifest.clone();
        manifest["identity"] = plan.identity()?;
        Self { path: self.path.clone(), manifest }.check_same(self)
    }

    /// The table of all chunks, which are joined before.
    ///
    /// # Errors
    /// [`StudyError::Missing`] if not all are there, and those of [`merge`](Self::merge).
    pub(crate) fn table(&self) -> Result<StudyTable, StudyError> {
        if !self.is_complete() {
            self.merge()?;
        }
        StudyTable::open(self.path.join(PARQUET), &self.manifest["identity"])
    }

    /// All rows in memory, which are joined before: inputs, observables (NaN where a run has none),
    /// `error` and `warnings`.
    ///
    /// # Errors
    /// [`StudyError::Missing`] if not all chunks are there, [`StudyError::Table`] for a damaged table, and
    /// those of [`merge`](Self::merge).
    pub fn results(&self) -> Result<DataTable, StudyError> {
        let columns = self.columns();
        self.table()?.columns(columns.iter().map(|(name, role)| (name.as_str(), role.is_number())))
    }

    /// Names of the observables.
    pub(crate) fn observables(&self) -> Vec<String> {
        let columns = self.columns().into_iter();
        columns.filter(|(_, role)| *role == Role::Observable).map(|(name, _)| name).collect()
    }

    /// Writes another file of the study whole.
    ///
    /// # Errors
    /// [`StudyError::Io`].
    pub fn write(&self, name: &str, contents: impl AsRef<[u8]>) -> Result<PathBuf, StudyError> {
        let path = self.path.join(name);
        write_whole(&path, |file| file.write_all(contents.as_ref())).map_err(self.fail(name))?;
        Ok(path)
    }

    /// True if the chunk is on disk, or the table of all chunks.
    pub(crate) fn has(&self, chunk: u64) -> bool {
        self.chunk_path(chunk).exists()
    }

    /// True if the table of all chunks is on disk.
    pub fn is_complete(&self) -> bool {
        self.path.join(TABLE).exists()
    }

    fn chunk_path(&self, chunk: u64) -> PathBuf {
        self.path.join(CHUNKS).join(format!("{chunk:08}.csv"))
    }

    fn mark(&self, chunk: u64) -> String {
        let of = |key: &str| self.manifest["identity"][key].as_str().unwrap_or_default();
        let (scenario, study) = (of("scenario_sha256"), of("study_sha256"));
        format!("{CHUNK_MARK} {chunk} scenario {scenario} study {study}")
    }

    /// Writes a chunk whole.
    pub(crate) fn write_chunk(&self, chunk: u64, rows: &str) -> Result<(), StudyError> {
        let path = self.chunk_path(chunk);
        write_whole(&path, |file| {
            writeln!(file, "{}", self.mark(chunk))?;
            file.write_all(rows.as_bytes())
        })
        .map_err(|source| StudyError::Io { path, source })
    }

    /// Numbers of the chunks on disk.
    fn chunk_numbers(&self) -> Result<Vec<u64>, StudyError> {
        let folder = self.path.join(CHUNKS);
        let entries = match fs::read_dir(&folder) {
            Ok(entries) => entries,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            Err(source) => return Err(StudyError::Io { path: folder, source }),
        };
        let mut numbers = Vec::new();
        for entry in entries {
            let entry = entry.map_err(|source| StudyError::Io { path: folder.clone(), source })?;
            let name = entry.file_name();
            if is_temporary(&name) {
                continue;
            }
            let number = name.to_str().and_then(|name| name.strip_suffix(".csv")?.parse().ok());
            match number {
                Some(number)
                    if number < self.chunks() && self.chunk_path(number) == entry.path() =>
                {
                    numbers.push(number);
                }
                _ => {
                    let fault = "is no chunk of this study".to_owned();
                    return Err(StudyError::Chunk { file: entry.path(), fault });
                }
            }
        }
        numbers.sort_unstable();
        Ok(numbers)
    }

    /// Joins all chunks to one table, as CSV and as Parquet, and removes them.
    ///
    /// Each chunk is checked: it must name this study and its number, and have its number of rows.
    ///
    /// # Errors
    /// [`StudyError::Missing`] for chunks that are not there, [`StudyError::Chunk`] for one that
    /// is damaged or of another study, [`StudyError::Io`].
    pub fn merge(&self) -> Result<PathBuf, StudyError> {
        let table = self.path.join(TABLE);
        if !self.is_complete() {
            let present = self.chunk_numbers()?;
            let missing = self.chunks() - present.len() as u64;
            if missing > 0 {
                let first = (0..).zip(&present).find(|(at, number)| at != *number);
                let first = first.map_or(present.len() as u64, |(at, _)| at);
                let (folder, chunks) = (self.path.clone(), self.chunks());
                return Err(StudyError::Missing { folder, missing, chunks, first });
            }
            let columns = self.columns();
            // The study is complete once there is CSV, so that Parquet comes first.
            self.write_parquet(&columns)?;
            write_whole(&table, |file| {
                let header = CsvWriter::with_header(columns.iter().map(|(name, _)| name));
                file.write_all(header.into_string().as_bytes())?;
                for chunk in 0..self.chunks() {
                    let mut reader = BufReader::new(File::open(self.chunk_path(chunk))?);
                    reader.read_line(&mut String::new())?;
                    io::copy(&mut reader, file)?;
                }
                Ok(())
            })
            .map_err(self.fail(TABLE))?;
        }
        // Killed runs may have left these beside the table.
        for entry in fs::read_dir(&self.path).map_err(self.fail(""))?.flatten() {
            if is_temporary(&entry.file_name()) {
                let _ = fs::remove_file(entry.path());
            }
        }
        match fs::remove_dir_all(self.path.join(CHUNKS)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(self.fail(CHUNKS)(error)),
            _ => Ok(table),
        }
    }

    /// Writes the table as Parquet, and checks each chunk meanwhile.
    fn write_parquet(&self, columns: &[(String, Role)]) -> Result<(), StudyError> {
        let mut fault = None;
        let written = write_whole(&self.path.join(PARQUET), |file| {
            let mut table = ParquetTable::new(file, columns, &self.manifest["identity"])?;
            for chunk in 0..self.chunks() {
                if let Err(error) = self.read_chunk(chunk, columns.len(), &mut table) {
                    fault = Some(error);
                    return Err(io::ErrorKind::InvalidData.into());
                }
            }
            table.finish()
        });
        match fault {
            Some(fault) => Err(fault),
            None => written.map_err(self.fail(PARQUET)),
        }
    }

    /// Adds the rows of a chunk to a table.
    fn read_chunk(
        &self,
        chunk: u64,
        columns: usize,
        table: &mut ParquetTable<impl Write + Send>,
    ) -> Result<(), StudyError> {
        let file = self.chunk_path(chunk);
        let fault = |fault: &str| {
            Err(StudyError::Chunk { file: self.chunk_path(chunk), fault: fault.to_owned() })
        };
        let opened = File::open(&file).map_err(|source| StudyError::Io { path: file, source })?;
        let mut reader = BufReader::new(opened);
        let mut mark = String::new();
        if reader.by_ref().take(1 << 12).read_line(&mut mark).is_err()
            || mark.trim_end() != self.mark(chunk)
        {
            return fault("is a chunk of another study, or of another place in it");
        }
        let mut rows = csv::ReaderBuilder::new().has_headers(false).from_reader(reader);
        let mut count = 0;
        let mut record = csv::StringRecord::new();
        loop {
            match rows.read_record(&mut record) {
                Ok(true) if record.len() == columns => count += 1,
                Ok(false) => break,
                Ok(true) | Err(_) => return fault("is damaged: a row has other columns"),
            }
            match table.push(&record) {
                Err(error) if error.kind() == io::ErrorKind::InvalidData => {
                    return fault("is damaged: a text stands for a number");
                }
                written => written.map_err(self.fail(PARQUET))?,
            }
        }
        let expected = self.rows_of(chunk);
        if count != expected.end - expected.start {
            return fault("is damaged: it has another number of rows");
        }
        Ok(())
    }

    fn fail(&self, name: &str) -> impl FnOnce(io::Error) -> StudyError + use<> {
        let path = self.path.join(name);
        |source| StudyError::Io { path, source }
    }
}

/// True for what a killed run, or a shard that begins at the same time, may have left.
fn is_ours(entry: &fs::DirEntry) -> bool {
    let name = entry.file_name();
    is_temporary(&name) || name == MANIFEST || name == CHUNKS
}

/// True for the name of a file that is being written, or was when its writer was killed.
fn is_temporary(name: &OsStr) -> bool {
    name.to_str().is_some_and(|name| name.starts_with(BEGUN))
}

/// Writes a file under another name, brings it to the disk and renames it: it is whole or absent.
fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<()>,
) -> io::Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    // Shards on several machines do not meet in one name: the file must be new.
    builder.prefix(BEGUN);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Those of a new file; temporary files are private to their owner.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut temporary = builder.tempfile_in(folder)?;
    let mut file = BufWriter::new(temporary.as_file_mut());
    write(&mut file)?;
    file.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()?;
    temporary.persist(path).map_err(|error| error.error)?;
    // The name itself; a folder cannot be opened everywhere.
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}
