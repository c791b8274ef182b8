//! Files and streams that are read to their end: recordings, or bytes as they are.

pub(crate) mod mcap;

use std::fs::File;
use std::io::{self, IsTerminal, Read};
use std::path::{Path, PathBuf};

use indicatif::{ProgressBar, ProgressStyle};

use crate::recording::{Entry, Parser, is_recording};
use crate::screen::complain;
use crate::status::Failure;

/// Bytes that are read at a time.
pub const CHUNK: usize = 1 << 16;
/// A file of this size is read before anyone could want to know how long it takes.
const SHORT: u64 = 1 << 24;

/// What a source is made of.
#[derive(Debug)]
enum Content {
    /// Its first bytes don't say it yet.
    Unknown(Vec<u8>),
    Raw,
    Recording(Box<Parser>),
}

/// What was read from it.
pub(crate) enum Piece<'a> {
    Raw(&'a [u8]),
    Entry(&'a Entry, &'a Parser),
}

/// A source of either.
#[derive(Debug)]
pub(crate) struct Source {
    name: PathBuf,
    content: Content,
}

impl Source {
    pub(crate) fn new(name: &Path) -> Self {
        Self { name: name.to_owned(), content: Content::Unknown(Vec::new()) }
    }

    pub(crate) const fn is_recording(&self) -> bool {
        matches!(self.content, Content::Recording(_))
    }

    /// Takes bytes, and gives what they are to `take`, until that returns false.
    pub(crate) fn feed(
        &mut self,
        bytes: &[u8],
        mut take: impl FnMut(Piece) -> Result<bool, Failure>,
    ) -> Result<(), Failure> {
        let begun;
        let mut rest = bytes;
        if let Content::Unknown(first) = &mut self.content {
            first.extend_from_slice(bytes);
            let Some(is_recording) = is_recording(first) else { return Ok(()) };
            begun = std::mem::take(first);
            rest = &begun;
            self.content = if is_recording { Content::Recording(Box::new(Parser::new())) } else { Content::Raw };
        }
        let Content::Recording(parser) = &mut self.content else { return take(Piece::Raw(rest)).map(drop) };
        loop {
            let entry = parser.next(&mut rest).map_err(|error| Failure::of(self.name.display(), error))?.cloned();
            let Some(entry) = entry else { return Ok(()) };
            if !take(Piece::Entry(&entry, parser))? {
                return Ok(());
            }
        }
    }

    /// Says what could not be read.
    pub(crate) fn complain_about_damage(&self) {
        if let Content::Recording(parser) = &self.content
            && let Some(damage) = parser.damage()
        {
            complain(&format!("{}: {damage}", self.name.display()));
        }
    }

    /// Nothing follows.
    pub(crate) fn end(&mut self, mut take: impl FnMut(Piece) -> Result<bool, Failure>) -> Result<(), Failure> {
        match &mut self.content {
            Content::Unknown(bytes) => take(Piece::Raw(bytes)).map(drop),
            Content::Raw => Ok(()),
            Content::Recording(parser) => {
                let entry = parser.end().map_err(|error| Failure::of(self.name.display(), error))?.cloned();
                if let Some(entry) = entry {
                    take(Piece::Entry(&entry, parser))?;
                }
                Ok(())
            }
        }
    }
}

/// A file that is read from its beginning to its end, with progress on a terminal where nothing else is printed.
pub(crate) struct Progress {
    file: File,
    name: PathBuf,
    bar: ProgressBar,
    room: Vec<u8>,
    /// What makes text of MCAP.
    converter: Option<mcap::Converter>,
}

impl Progress {
    pub(crate) fn open(path: &Path) -> Result<Self, Failure> {
        let failure = |error: &io::Error| Failure::of_file(path.display(), error);
        let mut file = File::open(path).map_err(|error| failure(&error))?;
        let mut length = file.metadata().map_err(|error| failure(&error))?.len();
        let mut converter = None;
        if mcap::is_mcap(&mut file).map_err(|error| failure(&error))? {
            // How long the text will be is not known.
            length = 0;
            let (started, text) = mcap::Converter::start(path)?;
            (converter, file) = (Some(started), text);
        }
        let is_shown = length >= SHORT && !io::stdout().is_terminal();
        let bar = if is_shown { ProgressBar::new(length) } else { ProgressBar::hidden() };
        let style = ProgressStyle::with_template("{wide_bar} {percent:>3} % of {total_bytes}, {eta} left");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        Ok(Self { file, name: path.to_owned(), bar, room: vec![0; CHUNK], converter })
    }

    /// The same file again: what is the matter with it has been said.
    pub(crate) fn again(path: &Path) -> Result<Self, Failure> {
        let mut progress = Self::open(path)?;
        progress.converter.iter_mut().for_each(mcap::Converter::silence);
        Ok(progress)
    }

    /// The next bytes; none at the end.
    pub(crate) fn read(&mut self) -> Result<&[u8], Failure> {
        let count = loop {
            match self.file.read(&mut self.room) {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => (),
                Err(error) => return Err(Failure::of_file(self.name.display(), &error)),
                Ok(count) => break count,
            }
        };
        if count == 0
            && let Some(converter) = self.converter.take()
        {
            converter.end()?;
        }
        self.bar.inc(u64::try_from(count).unwrap_or_default());
        Ok(self.room.get(..count).unwrap_or_default())
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
