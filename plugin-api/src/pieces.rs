//! A file read by several threads: pieces of it are read in any order, and taken in theirs ([`in_order`]). A text is cut into them at
//! line ends ([`Text`]).
//!
//! What comes of a text does not depend on the number of threads: pieces end where the text says, and the first line that is
//! wrong is the one that is told.
//!
//! ```
//! use pointstage_plugin_api::lines::{Lines, number};
//! use pointstage_plugin_api::loading::{Column, Output, bytes_of};
//! use pointstage_plugin_api::pieces::{Fault, Text};
//! use pointstage_plugin_api::{Host, Progress, Result};
//!
//! /// A number a line is a point on the x axis.
//! fn load(file: &[u8], host: &Host, out: &mut Output<'_>, progress: &Progress<'_>) -> Result<()> {
//!     out.columns(&[Column::POSITION_F64], 0)?;
//!     Text::new(Lines::new(file), "reading points").read(
//!         host,
//!         progress,
//!         |lines| {
//!             lines
//!                 .map(|line| number(line.text).map(|x| [x, 0.0, 0.0]).ok_or_else(|| Fault::new(&line, "expected a number")))
//!                 .collect::<Result<Vec<[f64; 3]>, Fault>>()
//!         },
//!         |points| out.rows(points.len(), &[bytes_of(&points)]),
//!     )
//! }
//! ```

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use memchr::memchr2;

use crate::error::{Error, Result};
use crate::host::{Host, Progress};
use crate::lines::{Line, Lines};

/// Text read by one thread at a time, bytes: a few milliseconds between two looks at the cancel flag.
const PIECE_BYTES: usize = 256 << 10;

/// What is wrong with a line of a piece.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// From 1, in the piece.
    line: u64,
    message: String,
}

impl Fault {
    /// Of a line of the piece. The message says what was expected, what was found, and what to do; the line's number in the file
    /// is put before it.
    pub fn new(line: &Line<'_>, message: impl Into<String>) -> Self {
        Self {
            line: line.number,
            message: message.into(),
        }
    }
}

/// A text to be read.
#[derive(Clone, Debug)]
pub struct Text<'t> {
    lines: Lines<'t>,
    stage: &'t str,
    part: Range<f32>,
    may_begin: fn(&[u8], usize) -> bool,
    start: usize,
}

impl<'t> Text<'t> {
    /// What `lines` has not read yet; `stage` tells people what is being done.
    pub fn new(lines: Lines<'t>, stage: &'t str) -> Self {
        Self {
            start: lines.position(),
            lines,
            stage,
            part: 0.0..1.0,
            may_begin: |_, _| true,
        }
    }

    /// Begins at byte `start`, where a line begins, instead of where `lines` stands.
    #[must_use]
    pub fn from_byte(mut self, start: usize) -> Self {
        self.start = start;
        self
    }

    /// Part of the whole work that this is; 0 to 1 otherwise.
    #[must_use]
    pub fn with_part(mut self, part: Range<f32>) -> Self {
        self.part = part;
        self
    }

    /// Pieces begin only at bytes of the text for which this holds; it is asked of starts of lines.
    #[must_use]
    pub fn with_begin(mut self, may_begin: fn(&[u8], usize) -> bool) -> Self {
        self.may_begin = may_begin;
        self
    }

    /// Reads the pieces, on as many threads as the host allows, and takes what comes of them on this one, in their order.
    ///
    /// # Errors
    /// Of `read`, as 'line N: message'; of `take`; and once the load is cancelled.
    pub fn read<T: Send>(
        &self,
        host: &Host,
        progress: &Progress<'_>,
        read: impl Fn(Lines<'t>) -> Result<T, Fault> + Sync,
        take: impl FnMut(T) -> Result<()>,
    ) -> Result<()> {
        self.read_on(host.thread_count(), progress, read, take)
    }

    fn read_on<T: Send>(
        &self,
        threads: usize,
        progress: &Progress<'_>,
        read: impl Fn(Lines<'t>) -> Result<T, Fault> + Sync,
        mut take: impl FnMut(T) -> Result<()>,
    ) -> Result<()> {
        let text = self.lines.text();
        let first = self.piece(self.start);
        let pieces = std::iter::successors(first, |piece| self.piece(piece.end));
        in_order(
            threads,
            pieces,
            |piece| read(Lines::new(&text[piece.clone()])),
            |piece, result| {
                progress.check()?;
                take(result.map_err(|fault| self.error(piece.start, &fault))?)?;
                let done = piece.end as f64 / text.len().max(1) as f64;
                let Range { start, end } = self.part;
                progress.set(start + (end - start) * done as f32, self.stage);
                Ok(())
            },
        )
    }

    /// The piece that begins at `start`.
    fn piece(&self, start: usize) -> Option<Range<usize>> {
        let text = self.lines.text();
        if start >= text.len() {
            return None;
        }
        let mut end = start + PIECE_BYTES;
        loop {
            let found = text.get(end..).and_then(|rest| memchr2(b'\n', b'\r', rest));
            let Some(found) = found else {
                return Some(start..text.len());
            };
            end += found;
            end += match text[end..] {
                [b'\r', b'\n', ..] => 2,
                _ => 1,
            };
            if end == text.len() || (self.may_begin)(text, end) {
                return Some(start..end);
            }
        }
    }

    /// The error of a fault in the piece that begins at `start`.
    fn error(&self, start: usize, fault: &Fault) -> Error {
        let before = self.lines.clone().until(start).count() as u64;
        let number = self.lines.number() + before + fault.line;
        Error::failed(format!("line {number}: {}", fault.message))
    }
}

/// Has `threads` threads make something of each piece, and takes the results on this one, in the order of the pieces.
///
/// No more than a few pieces a thread wait to be taken. A single piece takes no thread.
///
/// # Errors
/// Of `take`; no further piece is taken then.
pub fn in_order<P: Send, T: Send>(
    threads: usize,
    pieces: impl Iterator<Item = P> + Send,
    read: impl Fn(&P) -> T + Sync,
    mut take: impl FnMut(P, T) -> Result<()>,
) -> Result<()> {
    let mut pieces = pieces.peekable();
    let Some(first) = pieces.next() else {
        return Ok(());
    };
    if pieces.peek().is_none() {
        let result = read(&first);
        return take(first, result);
    }
    let work = Work {
        // Enough that nobody waits for a piece that takes longer than others.
        ahead: 2 * threads + 2,
        state: Mutex::new(State {
            pieces: std::iter::once(first).chain(pieces),
            given: 0,
            taken: 0,
            is_all_given: false,
            is_over: false,
            results: BTreeMap::new(),
        }),
        changed: Condvar::new(),
    };
    std::thread::scope(|scope| {
        // Should taking panic, the threads must not wait for ever.
        let _over = Over(&work);
        for _ in 0..threads.max(1) {
            scope.spawn(|| {
                let _over = OverByPanic(&work);
                while let Some((number, piece)) = work.give() {
                    let result = read(&piece);
                    work.put(number, piece, result);
                }
            });
        }
        while let Some((piece, result)) = work.next() {
            take(piece, result)?;
        }
        Ok(())
    })
}

/// Pieces that threads share.
struct Work<I: Iterator, T> {
    /// Pieces that may be read before the first of them is taken.
    ahead: usize,
    state: Mutex<State<I, T>>,
    changed: Condvar,
}

struct State<I: Iterator, T> {
    pieces: I,
    /// Pieces that were given to a thread.
    given: usize,
    taken: usize,
    is_all_given: bool,
    /// Nobody takes any more.
    is_over: bool,
    /// What came of pieces, by their number.
    results: BTreeMap<usize, (I::Item, T)>,
}

impl<I: Iterator, T> Work<I, T> {
    fn lock(&self) -> MutexGuard<'_, State<I, T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'g>(&self, guard: MutexGuard<'g, State<I, T>>) -> MutexGuard<'g, State<I, T>> {
        self.changed
            .wait(guard)
            .unwrap_or_else(PoisonError::into_inner)
    }

    /// The next piece to be read and its number; `None` if there is none.
    fn give(&self) -> Option<(usize, I::Item)> {
        let mut state = self.lock();
        while !state.is_over && state.given - state.taken >= self.ahead {
            state = self.wait(state);
        }
        if state.is_over || state.is_all_given {
            return None;
        }
        let Some(piece) = state.pieces.next() else {
            state.is_all_given = true;
            self.changed.notify_all();
            return None;
        };
        state.given += 1;
        Some((state.given - 1, piece))
    }

    fn put(&self, number: usize, piece: I::Item, result: T) {
        self.lock().results.insert(number, (piece, result));
        self.changed.notify_all();
    }

    /// What came of the next piece; `None` behind the last.
    fn next(&self) -> Option<(I::Item, T)> {
        let mut state = self.lock();
        loop {
            let number = state.taken;
            if let Some(result) = state.results.remove(&number) {
                state.taken += 1;
                self.changed.notify_all();
                return Some(result);
            }
            if state.is_over || (state.is_all_given && state.taken == state.given) {
                return None;
            }
            state = self.wait(state);
        }
    }

    fn end(&self) {
        self.lock().is_over = true;
        self.changed.notify_all();
    }
}

/// Ends the work when it is dropped.
struct Over<'w, I: Iterator, T>(&'w Work<I, T>);

impl<I: Iterator, T> Drop for Over<'_, I, T> {
    fn drop(&mut self) {
        self.0.end();
    }
}

/// Ends the work if its thread panics.
struct OverByPanic<'w, I: Iterator, T>(&'w Work<I, T>);

impl<I: Iterator, T> Drop for OverByPanic<'_, I, T> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.end();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::Call;
    use std::cell::Cell;

    /// A call that ends after so many looks at its cancel flag.
    struct Looks(Cell<usize>);

    impl Call for Looks {
        fn stop(&self) -> bool {
            self.0.set(self.0.get().saturating_sub(1));
            self.0.get() == 0
        }

        fn report(&self, fraction: f32, _stage: &str) {
            assert!((0.0..=1.0).contains(&fraction), "{fraction}");
        }
    }

    fn endless() -> Looks {
        Looks(Cell::new(usize::MAX))
    }

    /// Some pieces of lines that hold their number, with each of the three ends.
    fn long_text() -> Vec<u8> {
        let mut text = Vec::new();
        for number in 1..120_000 {
            let end = ["\n", "\r\n", "\r"][number % 3];
            text.extend(format!("{number}{}{end}", " ".repeat(number % 19)).into_bytes());
        }
        text
    }

    /// The numbers of all lines, and how many pieces there were.
    fn read_all(text: &Text<'_>, threads: usize) -> (Vec<u64>, usize) {
        let (mut all, mut pieces) = (Vec::new(), 0);
        let read = |lines: Lines<'_>| {
            let numbers = lines.map(|line| line.words().next().and_then(crate::lines::integer));
            Ok(numbers.map(|number| number.unwrap_or(0) as u64).collect())
        };
        text.read_on(
            threads,
            &Progress::new(&endless()),
            read,
            |part: Vec<u64>| {
                all.extend(part);
                pieces += 1;
                Ok(())
            },
        )
        .expect("nothing is wrong");
        (all, pieces)
    }

    #[test]
    fn every_line_comes_once_and_in_its_place() {
        let text = long_text();
        for threads in [1, 2, 7] {
            let whole = Text::new(Lines::new(&text), "");
            let (all, pieces) = read_all(&whole, threads);
            assert!(all.iter().copied().eq(1..120_000), "{threads} threads");
            assert!(pieces > 3, "{pieces} pieces");
            let mut lines = Lines::new(&text);
            lines.nth(99);
            let (rest, _) = read_all(&Text::new(lines, ""), threads);
            assert!(rest.iter().copied().eq(101..120_000), "{threads} threads");
        }
        assert_eq!(read_all(&Text::new(Lines::new(b""), ""), 2).1, 0);
    }

    #[test]
    fn pieces_begin_where_they_may() {
        let text = long_text();
        let whole = Text::new(Lines::new(&text), "")
            .with_begin(|text, start| text[start..].starts_with(b"1"));
        let mut begins = Vec::new();
        let read = |mut lines: Lines<'_>| Ok(lines.next().map(|line| line.text[0]));
        whole
            .read_on(2, &Progress::new(&endless()), read, |first| {
                begins.extend(first);
                Ok(())
            })
            .expect("nothing is wrong");
        assert!(begins.len() > 3 && begins.iter().all(|first| *first == b'1'));
    }

    #[test]
    fn the_first_wrong_line_is_told() {
        let mut text = long_text();
        for wrong in [70_001, 110_001] {
            let word = format!("{wrong} ");
            let place = text
                .windows(word.len())
                .position(|part| part == word.as_bytes());
            text[place.expect("it is there")] = b'x';
        }
        let mut lines = Lines::new(&text);
        lines.nth(9);
        let mut later = lines.clone();
        later.nth(50_000);
        let whole = Text::new(lines, "");
        let rest = whole.clone().from_byte(later.position());
        for (text, threads) in [(&whole, 1), (&whole, 3), (&rest, 2)] {
            let result = text.read_on(
                threads,
                &Progress::new(&endless()),
                |mut lines| match lines.find(|line| line.text.starts_with(b"x")) {
                    Some(line) => Err(Fault::new(&line, "expected a number")),
                    None => Ok(()),
                },
                |()| Ok(()),
            );
            let said = result.expect_err("two lines are wrong").message;
            assert_eq!(said, "line 70001: expected a number");
        }
    }

    #[test]
    fn a_cancel_ends_it() {
        let text = long_text();
        let call = Looks(Cell::new(3));
        let mut taken = 0;
        let result = Text::new(Lines::new(&text), "").read_on(
            2,
            &Progress::new(&call),
            |_| Ok(()),
            |()| {
                taken += 1;
                Ok(())
            },
        );
        assert_eq!((result, taken), (Err(Error::cancelled()), 2));
    }

    #[test]
    #[should_panic(expected = "scoped thread panicked")]
    fn a_panic_of_a_thread_is_one_of_the_call() {
        let text = long_text();
        let read = |mut lines: Lines<'_>| {
            let first = lines.next().expect("a piece has lines");
            assert!(first.text.starts_with(b"1 "), "only the first piece");
            Ok(())
        };
        let _ =
            Text::new(Lines::new(&text), "")
                .read_on(2, &Progress::new(&endless()), read, |()| Ok(()));
    }
}
