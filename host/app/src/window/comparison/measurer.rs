//! Measures views off the window's thread: numbers against the reference, and the difference picture.

use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;

use egui::ColorImage;
use image::{Rgb, RgbImage};
use pointstage_engine::metrics::difference::difference_map;
use pointstage_engine::metrics::flip::flip;
use pointstage_engine::metrics::{Measured, Regions, measure, silhouette};
use pointstage_engine::stage::{FrameResult, Picture};

use super::Measure;

/// What is to be measured.
#[derive(Clone)]
pub(crate) struct Order {
    /// The views' pictures, in order.
    pub(crate) views: Vec<Arc<FrameResult>>,
    /// The place of the one that the others are measured against.
    pub(crate) reference: usize,
    /// The place of the one whose difference from the reference is to be shown, and how.
    pub(crate) difference: Option<(usize, Measure)>,
    /// Whether numbers are wanted.
    pub(crate) measures: bool,
}

/// What was measured.
pub(crate) struct Answer {
    /// Of what.
    pub(crate) order: Order,
    /// For each view; none for the reference itself.
    pub(crate) numbers: Vec<Option<Numbers>>,
    /// The difference, if one was wanted and can be.
    pub(crate) difference: Option<ColorImage>,
}

/// How far a view is from the reference.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Numbers {
    /// So far.
    Measured(Box<Measured>),
    /// It cannot be measured, for this reason.
    Not(String),
}

impl Numbers {
    /// The whole picture's numbers, shortly.
    pub(crate) fn in_words(&self) -> String {
        let measured = match self {
            Self::Measured(measured) => measured,
            Self::Not(reason) => return reason.clone(),
        };
        let whole = &measured.whole;
        if whole.identical {
            return "identical".to_owned();
        }
        let mut parts = Vec::new();
        parts.extend(whole.psnr_db.map(|psnr| format!("PSNR {psnr:.1} dB")));
        parts.extend(whole.ssim.map(|ssim| format!("SSIM {ssim:.4}")));
        parts.extend(whole.flip_mean.map(|flip| format!("FLIP {flip:.4}")));
        parts.join("  ")
    }
}

impl Order {
    /// Whether the same pictures are to be measured in the same way.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        self.reference == other.reference
            && self.difference == other.difference
            && self.measures == other.measures
            && self.views.len() == other.views.len()
            && self
                .views
                .iter()
                .zip(&other.views)
                .all(|(a, b)| Arc::ptr_eq(a, b))
    }

    /// Does it.
    fn carry_out(self) -> Answer {
        let reference = self.views.get(self.reference).cloned();
        let numbers = self.views.iter().enumerate().map(|(index, view)| {
            let reference = reference.as_ref().filter(|_| self.measures)?;
            (index != self.reference).then(|| numbers(reference, view))
        });
        let numbers = numbers.collect();
        let difference = self.difference.and_then(|(index, way)| {
            let view = self.views.get(index)?;
            difference(&reference?.picture, &view.picture, way)
        });
        Answer {
            order: self,
            numbers,
            difference,
        }
    }
}

impl Answer {
    /// The numbers of a view by its picture.
    pub(crate) fn numbers_of(&self, shown: &Arc<FrameResult>) -> Option<&Numbers> {
        let mut views = self.order.views.iter();
        let index = views.position(|view| Arc::ptr_eq(view, shown))?;
        self.numbers.get(index)?.as_ref()
    }

    /// Whether its difference is that of these two pictures, measured so.
    pub(crate) fn is_of(
        &self,
        measure: Measure,
        reference: Option<&Arc<FrameResult>>,
        view: Option<&Arc<FrameResult>>,
    ) -> bool {
        let at = |index: usize| self.order.views.get(index);
        let is = |own: Option<&Arc<FrameResult>>, other: Option<&Arc<FrameResult>>| {
            own.zip(other)
                .is_some_and(|(own, other)| Arc::ptr_eq(own, other))
        };
        let difference = self.order.difference;
        let differing = difference
            .filter(|(_, own)| *own == measure)
            .map(|(index, _)| index);
        is(at(self.order.reference), reference) && is(differing.and_then(at), view)
    }
}

fn numbers(reference: &FrameResult, view: &FrameResult) -> Numbers {
    let covered = covered(reference);
    let regions = Regions::new(reference.picture.size_px, &covered);
    let pictures = (rgb(&reference.picture), rgb(&view.picture));
    let (Some(regions), (Some(a), Some(b))) = (regions, pictures) else {
        return Numbers::Not("a picture is not whole".to_owned());
    };
    match measure(&a, &b, &regions) {
        Ok(measured) => Numbers::Measured(Box::new(measured)),
        Err(error) => Numbers::Not(error.to_string()),
    }
}

/// Where the reference draws something: as its ids or depths say, else wherever it is not see-through.
fn covered(reference: &FrameResult) -> Vec<bool> {
    let planes = &reference.planes;
    if let Some(plane) = planes.get("id").or_else(|| planes.get("depth")) {
        return silhouette(plane);
    }
    let pixels = reference.picture.rgba.chunks_exact(4);
    pixels.map(|pixel| pixel[3] > 0).collect()
}

/// The picture without its coverage, over black where it has any.
fn rgb(picture: &Picture) -> Option<RgbImage> {
    let [width, height] = picture.size_px;
    let pixels = picture.rgba.chunks_exact(4).flat_map(|pixel| {
        let [red, green, blue, alpha] = [pixel[0], pixel[1], pixel[2], pixel[3]];
        let over = |channel: u8| (u16::from(channel) * u16::from(alpha) / 255) as u8;
        [red, green, blue].map(over)
    });
    RgbImage::from_raw(width, height, pixels.collect())
}

/// The difference of `view` from `reference`; none of pictures of two sizes.
fn difference(reference: &Picture, view: &Picture, way: Measure) -> Option<ColorImage> {
    if reference.size_px != view.size_px {
        return None;
    }
    let (reference, view) = (rgb(reference)?, rgb(view)?);
    let map = match way {
        Measure::Absolute => difference_map(&reference, &view),
        Measure::Signed => signed(&reference, &view),
        Measure::Flip => flip(&reference, &view)?.map,
    };
    let size = [map.width() as usize, map.height() as usize];
    Some(ColorImage::from_rgb(size, map.as_raw()))
}

/// Signed differences up to this, in steps of 8 bits, have a colour of their own.
pub(crate) const SIGNED_FULL: f32 = 32.0;

/// White where the mean of the channels is equal, blue where the view is darker and red where it is brighter.
fn signed(reference: &RgbImage, view: &RgbImage) -> RgbImage {
    RgbImage::from_fn(reference.width(), reference.height(), |x, y| {
        let mean = |image: &RgbImage| {
            let channels = image.get_pixel(x, y).0;
            channels
                .iter()
                .map(|channel| f32::from(*channel))
                .sum::<f32>()
                / 3.0
        };
        Rgb(signed_colour((mean(view) - mean(reference)) / SIGNED_FULL))
    })
}

/// The colour of a signed part, −1 to 1: the ends of ColorBrewer's diverging *RdBu*, through white.
pub(crate) fn signed_colour(part: f32) -> [u8; 3] {
    let end: [f32; 3] = if part < 0.0 {
        [33.0, 102.0, 172.0]
    } else {
        [178.0, 24.0, 43.0]
    };
    let weight = part.abs().min(1.0);
    end.map(|channel| (255.0 + (channel - 255.0) * weight).round() as u8)
}

/// The thread that measures. An order that waits is replaced by the next one.
pub(crate) struct Measurer {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

struct Shared {
    state: Mutex<State>,
    ordered: Condvar,
    wake: Arc<dyn Fn() + Send + Sync>,
}

#[derive(Default)]
struct State {
    /// The order that is carried out or was last.
    current: Option<Order>,
    waiting: Option<Order>,
    answer: Option<Answer>,
    is_busy: bool,
    quits: bool,
}

impl Measurer {
    /// Starts the thread; `wake` is called there with every answer.
    ///
    /// # Errors
    /// The system gives no thread.
    pub(crate) fn start(wake: Arc<dyn Fn() + Send + Sync>) -> std::io::Result<Self> {
        let shared = Arc::new(Shared {
            state: Mutex::default(),
            ordered: Condvar::new(),
            wake,
        });
        let for_thread = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name("pointstage-measurer".to_owned())
            .spawn(move || for_thread.run())?;
        Ok(Self {
            shared,
            thread: Some(thread),
        })
    }

    /// Has something measured, unless just that is being measured already.
    pub(crate) fn order(&self, order: Order) {
        let mut state = self.shared.lock();
        let last = state.waiting.as_ref().or(state.current.as_ref());
        if last.is_some_and(|last| last.is_same(&order)) {
            return;
        }
        state.waiting = Some(order);
        state.is_busy = true;
        self.shared.ordered.notify_one();
    }

    /// The newest answer, once.
    pub(crate) fn take(&self) -> Option<Answer> {
        self.shared.lock().answer.take()
    }

    /// Whether something is being measured, or was and has not been taken.
    pub(crate) fn is_busy(&self) -> bool {
        let state = self.shared.lock();
        state.is_busy || state.answer.is_some()
    }
}

impl Drop for Measurer {
    fn drop(&mut self) {
        self.shared.lock().quits = true;
        self.shared.ordered.notify_one();
        if let Some(thread) = self.thread.take() {
            // A panic was reported by the panic hook.
            let _ = thread.join();
        }
    }
}

impl Shared {
    fn lock(&self) -> std::sync::MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn run(&self) {
        while let Some(order) = self.next() {
            let answer = order.carry_out();
            let mut state = self.lock();
            state.answer = Some(answer);
            state.is_busy = state.waiting.is_some();
            drop(state);
            (self.wake)();
        }
    }

    fn next(&self) -> Option<Order> {
        let mut state = self.lock();
        loop {
            if state.quits {
                return None;
            }
            if let Some(order) = state.waiting.take() {
                state.current = Some(order.clone());
                return Some(order);
            }
            state = self
                .ordered
                .wait(state)
                .unwrap_or_else(PoisonError::into_inner);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;
    use std::time::Duration;

    use super::*;
    use crate::window::test_frames::frame_of_square;

    fn brighter(frame: &FrameResult, step: u8) -> Arc<FrameResult> {
        let mut frame = frame.clone();
        let mut rgba = frame.picture.rgba.to_vec();
        for pixel in rgba.chunks_exact_mut(4) {
            pixel[0] = pixel[0].saturating_add(step);
        }
        frame.picture.rgba = rgba.into();
        Arc::new(frame)
    }

    fn order(views: Vec<Arc<FrameResult>>, difference: Option<(usize, Measure)>) -> Order {
        Order {
            views,
            reference: 0,
            difference,
            measures: true,
        }
    }

    #[test]
    fn the_same_picture_differs_by_exactly_nothing() {
        let (_, shown) = frame_of_square(&["id"]);
        let shown = Arc::new(shown);
        let other = Arc::new(FrameResult::clone(&shown));
        for measure in [Measure::Absolute, Measure::Signed, Measure::Flip] {
            let views = vec![Arc::clone(&shown), Arc::clone(&other)];
            let answer = order(views, Some((1, measure))).carry_out();
            assert_eq!(answer.numbers_of(&shown), None, "the reference");
            let Some(Numbers::Measured(measured)) = answer.numbers_of(&other) else {
                panic!("it is measured");
            };
            assert!(measured.whole.identical);
            assert_eq!(measured.whole.psnr_db, Some(f64::INFINITY));
            let map = answer.difference.expect("of one size");
            let nothing = match measure {
                Measure::Signed => egui::Color32::WHITE,
                _ => map.pixels[0],
            };
            assert!(
                map.pixels.iter().all(|pixel| *pixel == nothing),
                "{measure:?}"
            );
        }
    }

    #[test]
    fn a_brighter_view_is_red_and_one_of_another_size_is_not_measured() {
        let (_, shown) = frame_of_square(&["id"]);
        let shown = Arc::new(shown);
        let bright = brighter(&shown, 96);
        let views = vec![Arc::clone(&shown), Arc::clone(&bright)];
        let answer = order(views, Some((1, Measure::Signed))).carry_out();
        let map = answer.difference.expect("of one size");
        assert!(map.pixels.iter().any(|pixel| pixel.r() > pixel.b()));
        assert!(map.pixels.iter().all(|pixel| pixel.r() >= pixel.b()));
        assert_eq!(signed_colour(-1.0), [33, 102, 172]);
        let mut small = FrameResult::clone(&shown);
        small.picture.size_px = [1, 1];
        small.picture.rgba = shown.picture.rgba[..4].into();
        let small = Arc::new(small);
        let views = vec![shown, Arc::clone(&small)];
        let answer = order(views, Some((1, Measure::Absolute))).carry_out();
        assert!(matches!(answer.numbers_of(&small), Some(Numbers::Not(_))));
        assert!(answer.difference.is_none());
    }

    #[test]
    fn the_thread_answers_the_last_order() {
        let (_, shown) = frame_of_square(&["id"]);
        let shown = Arc::new(shown);
        let (wake, woken) = channel();
        let measurer = Measurer::start(Arc::new(move || {
            // Nobody listens any more when the test has ended.
            let _ = wake.send(());
        }))
        .expect("a thread");
        let last = brighter(&shown, 3);
        for view in [brighter(&shown, 1), brighter(&shown, 2), Arc::clone(&last)] {
            measurer.order(order(vec![Arc::clone(&shown), view], None));
        }
        let is_last = |answer: Answer| Arc::ptr_eq(&answer.order.views[1], &last);
        loop {
            woken
                .recv_timeout(Duration::from_mins(1))
                .expect("an answer");
            if measurer.take().is_some_and(is_last) {
                break;
            }
        }
        assert!(!measurer.is_busy());
    }
}
