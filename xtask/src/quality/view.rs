//! Where pictures are drawn from: near, middle and far.

use super::SIZE_PX;
use crate::json::Value;

/// How far the eye is from the pivot, in distances at which the model fills the picture, with a name.
pub(super) type Distance = (&'static str, f64);

/// What the program calls a view record, in perspective.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct View {
    pub(super) eye: [f64; 3],
    pub(super) pivot: [f64; 3],
    pub(super) up: [f64; 3],
    pub(super) fov_y_rad: f64,
    pub(super) near: f64,
}

impl View {
    /// Reads a view record; `None` when it is none, or not in perspective.
    pub(super) fn of(record: &Value) -> Option<Self> {
        let vector = |key| {
            let numbers: Vec<f64> = record
                .get(key)?
                .items()
                .iter()
                .filter_map(Value::as_number)
                .collect();
            numbers.try_into().ok()
        };
        Some(Self {
            eye: vector("eye")?,
            pivot: vector("pivot")?,
            up: vector("up")?,
            fov_y_rad: record.get("projection")?.number("fov_y_rad")?,
            near: record.number("near")?,
        })
    }

    /// The same with the eye `factor` times as far from the pivot.
    pub(super) fn moved(self, factor: f64) -> Self {
        let Self {
            eye, pivot, near, ..
        } = self;
        Self {
            eye: std::array::from_fn(|axis| pivot[axis] + (eye[axis] - pivot[axis]) * factor),
            near: near * factor,
            ..self
        }
    }

    /// As a view record.
    pub(super) fn json(&self) -> String {
        let Self {
            eye,
            pivot,
            up,
            fov_y_rad,
            near,
        } = self;
        let [width, height] = SIZE_PX;
        // The far plane matters to orthographic views only, but there is one.
        let far = near * 1e6;
        format!(
            "{{\"format\": 1, \"eye\": {eye:?}, \"pivot\": {pivot:?}, \"up\": {up:?},\n \
             \"projection\": {{\"kind\": \"perspective\", \"fov_y_rad\": {fov_y_rad:?}}},\n \
             \"near\": {near:?}, \"far\": {far:?}, \"width\": {width}, \"height\": {height}}}\n"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VIEW: View = View {
        eye: [1.0, 2.0, 13.0],
        pivot: [1.0, 2.0, 3.0],
        up: [0.0, 1.0, 0.0],
        fov_y_rad: 0.7,
        near: 0.01,
    };

    #[test]
    fn the_eye_moves_along_its_line_of_sight() {
        let far = VIEW.moved(4.0);
        assert_eq!(far.eye, [1.0, 2.0, 43.0]);
        assert_eq!((far.pivot, far.near), (VIEW.pivot, 0.04));
        assert_eq!(VIEW.moved(1.0), VIEW);
    }

    #[test]
    fn a_record_reads_back_as_it_was() {
        let tiny = View { near: 1e-9, ..VIEW };
        for view in [VIEW, tiny] {
            let record = Value::parse(&view.json()).expect("JSON");
            assert_eq!(View::of(&record), Some(view));
        }
    }

    #[test]
    fn what_is_no_record_in_perspective_is_none() {
        for text in ["[]", "{\"eye\": [1, 2]}"] {
            assert_eq!(View::of(&Value::parse(text).expect("JSON")), None, "{text}");
        }
    }
}
