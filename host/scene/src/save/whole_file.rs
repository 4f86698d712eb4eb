//! A file that appears whole or not at all.

use std::ffi::OsString;
use std::fs::File;
use std::io::{self, BufWriter, Write as _};
use std::path::Path;

use super::SaveError;

/// Writes `path` under a neighbouring name first.
pub(super) fn write<T>(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<File>) -> Result<T, SaveError>,
) -> Result<T, SaveError> {
    let at = |source: io::Error| SaveError::Io {
        path: path.to_path_buf(),
        source,
    };
    let name = path
        .file_name()
        .ok_or_else(|| at(io::ErrorKind::IsADirectory.into()))?;
    let mut temporary = OsString::from(".");
    temporary.push(name);
    temporary.push(format!(".{}.part", std::process::id()));
    let temporary = path.with_file_name(temporary);
    let written = File::create(&temporary)
        .map_err(SaveError::Write)
        .and_then(|file| {
            let mut out = BufWriter::new(file);
            let answer = fill(&mut out)?;
            out.flush()?;
            let file = out.into_inner().map_err(io::IntoInnerError::into_error)?;
            file.sync_all()?;
            std::fs::rename(&temporary, path)?;
            Ok(answer)
        });
    written.map_err(|error| {
        // The error that matters is the one before; this one would tell that there is no such file.
        let _ = std::fs::remove_file(&temporary);
        match error {
            SaveError::Write(source) => at(source),
            other => other,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scan.ply");
        write(&path, |out| Ok(out.write_all(b"old")?)).unwrap();
        let failed = write(&path, |out| {
            out.write_all(b"half")?;
            Err::<(), _>(SaveError::Write(io::Error::other("full")))
        });
        let message = failed.unwrap_err().to_string();
        assert!(
            message.contains("scan.ply: cannot be written: full"),
            "{message}"
        );
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        assert!(write(Path::new("/"), |_| Ok(())).is_err());
    }
}
