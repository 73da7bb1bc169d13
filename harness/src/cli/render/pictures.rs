//! Where pictures go: each is written as it comes, so that no more than one is held.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use envs::render::Image;
use tempfile::NamedTempFile;

use crate::error::HarnessError;
use crate::files::new_file;

/// Speed of the GIF's colour reduction, 1 (best) to 30.
const GIF_SPEED: i32 = 10;

/// Takes pictures one after another.
pub(super) trait Album {
    /// Adds a picture that stays for `hundredths` of a second, where pictures move.
    fn add(&mut self, image: &Image, hundredths: u16) -> Result<(), HarnessError>;

    /// Makes what was added lasting. An album that is dropped before leaves nothing behind.
    fn finish(self: Box<Self>) -> Result<(), HarnessError>;
}

/// Begins an animation.
type Begin = fn(PathBuf, u32) -> Result<Box<dyn Album>, HarnessError>;

/// Formats of animations by the ends of their files' names.
const FORMATS: &[(&str, Begin)] = &[("gif", Animation::begin)];

/// The animation at `path`, in the format that its name ends with, of square pictures with `side` pixels.
///
/// # Errors
/// [`HarnessError`] if there is no such format, or the file cannot be written.
pub(super) fn animation(path: &Path, side: u32) -> Result<Box<dyn Album>, HarnessError> {
    let refused = |reason: String| HarnessError::Argument { option: "--out", reason };
    let end = path.extension().map(OsStr::to_ascii_lowercase).unwrap_or_default();
    let Some((_, begin)) = FORMATS.iter().find(|(known, _)| end == *known) else {
        let known: Vec<String> = FORMATS.iter().map(|(end, _)| format!(".{end}")).collect();
        let accepted = known.join(", ");
        return Err(refused(format!(
            "{}: animations are written as {accepted}; single pictures are with --frames",
            path.display()
        )));
    };
    if path.is_dir() {
        return Err(refused(format!("{} is a folder; name a file", path.display())));
    }
    begin(path.to_owned(), side)
}

/// An animated GIF, which appears when it is finished.
struct Animation {
    path: PathBuf,
    side: u16,
    file: NamedTempFile,
    encoder: gif::Encoder<BufWriter<File>>,
}

impl Animation {
    fn begin(path: PathBuf, side: u32) -> Result<Box<dyn Album>, HarnessError> {
        let side = u16::try_from(side).expect("pictures have at most 4096 pixels a side");
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let begun = || {
            std::fs::create_dir_all(folder)?;
            let file = new_file(folder)?;
            let mut encoder = gif::Encoder::new(BufWriter::new(file.reopen()?), side, side, &[])?;
            encoder.set_repeat(gif::Repeat::Infinite)?;
            Ok((file, encoder))
        };
        let (file, encoder) = begun().map_err(unwritable(&path))?;
        Ok(Box::new(Self { path, side, file, encoder }))
    }
}

impl Album for Animation {
    fn add(&mut self, image: &Image, hundredths: u16) -> Result<(), HarnessError> {
        let mut frame = gif::Frame::from_rgb_speed(self.side, self.side, image.pixels(), GIF_SPEED);
        frame.delay = hundredths;
        self.encoder.write_frame(&frame).map_err(unwritable(&self.path))
    }

    fn finish(self: Box<Self>) -> Result<(), HarnessError> {
        let Self { path, file, encoder, .. } = *self;
        let ended = || Ok(encoder.into_inner()?.into_inner().map_err(|error| error.into_error())?);
        ended().map_err(unwritable(&path))?;
        guard::fresh::put(file, &path).map_err(HarnessError::io(&path, "write this file"))?;
        Ok(())
    }
}

fn unwritable(path: &Path) -> impl FnOnce(gif::EncodingError) -> HarnessError {
    move |error| {
        let cause = match error {
            gif::EncodingError::Io(cause) => cause,
            other => std::io::Error::other(other),
        };
        HarnessError::io(path, "write this file")(cause)
    }
}

/// A folder of pictures of its own: `frame-0000.png` and so on.
pub(super) struct Frames {
    folder: PathBuf,
    /// Digits of a picture's number, so that names sort as pictures follow.
    digits: usize,
    written: Vec<PathBuf>,
    /// Whether the folder was made for these pictures.
    is_new: bool,
}

impl Frames {
    /// The folder at `folder`, for `pictures` of them.
    ///
    /// # Errors
    /// [`HarnessError`] if it holds anything: what it holds is not told apart from these pictures later.
    pub(super) fn begin(folder: &Path, pictures: u64) -> Result<Self, HarnessError> {
        let is_new = !folder.exists();
        fs::create_dir_all(folder).map_err(HarnessError::io(folder, "create this folder"))?;
        let mut entries = fs::read_dir(folder).map_err(HarnessError::io(folder, "read this folder"))?;
        if entries.next().is_some() {
            let reason = format!("{} is not empty; name a new or an empty folder", folder.display());
            return Err(HarnessError::Argument { option: "--frames", reason });
        }
        let digits = pictures.saturating_sub(1).to_string().len().max(4);
        Ok(Self { folder: folder.to_owned(), digits, written: Vec::new(), is_new })
    }
}

impl Album for Frames {
    fn add(&mut self, image: &Image, _: u16) -> Result<(), HarnessError> {
        let path = self.folder.join(format!("frame-{:0>1$}.png", self.written.len(), self.digits));
        self.written.push(path.clone());
        fs::write(&path, image.to_png()?).map_err(HarnessError::io(path, "write this file"))
    }

    fn finish(mut self: Box<Self>) -> Result<(), HarnessError> {
        self.written.clear();
        self.is_new = false;
        Ok(())
    }
}

impl Drop for Frames {
    fn drop(&mut self) {
        // What cannot be removed stays; why there are no pictures is being told already.
        for path in &self.written {
            let _ = fs::remove_file(path);
        }
        if self.is_new {
            let _ = fs::remove_dir(&self.folder);
        }
    }
}
