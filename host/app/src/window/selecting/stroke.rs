//! A drag with a tool over the picture, and its line.

use egui::{
    Color32, CursorIcon, Event, Key, Painter, PointerButton, Pos2, Rect, Response, Shape,
    Stroke as Line, Ui,
};
use glam::DVec2;
use pointstage_scene::MarkMode;
use pointstage_scene::edit::ScreenRegion;

use super::{Selecting, Tool};
use crate::window::comparison::Zoom;
use crate::window::comparison::zoom::part_of;
use crate::window::intent::{CompareIntent, Intents, SelectIntent};

/// Corners of a line that is drawn by hand are at least this far apart, points.
const LEAST_STEP: f32 = 1.5;

/// A drag under way.
#[derive(Clone, Debug)]
pub(super) struct Stroke {
    /// The view over which it began.
    view: usize,
    mode: MarkMode,
    /// Places of the pointer, points; the first and the last one for a rectangle.
    places: Vec<Pos2>,
}

/// A part of a view that was drawn with a tool.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Drawn {
    /// The view's place among all.
    pub(crate) view: usize,
    /// What it was drawn with.
    pub(crate) tool: Tool,
    /// Corners of the line or the way of the brush, as parts of the picture's width and height.
    pub(crate) places: Vec<[f32; 2]>,
    /// Radius of the brush, as a part of the picture's height.
    pub(crate) radius: f32,
}

impl Drawn {
    /// The same part of a picture of this size, px.
    pub(crate) fn region(&self, size_px: [u32; 2]) -> ScreenRegion {
        let [width, height] = size_px.map(f64::from);
        let place = |part: &[f32; 2]| {
            DVec2::new(part[0].into(), part[1].into()) * DVec2::new(width, height)
        };
        let places: Vec<DVec2> = self.places.iter().map(place).collect();
        match (self.tool, places.as_slice()) {
            (Tool::Rectangle, [first, .., last]) => ScreenRegion::rectangle(*first, *last),
            (Tool::Brush, places) => ScreenRegion::brush(places, f64::from(self.radius) * height),
            (_, places) => ScreenRegion::polygon(places),
        }
    }
}

impl Selecting {
    /// Follows the pointer over the picture of a view, paints what it draws, and asks for what was drawn.
    ///
    /// * `response`: the picture's answer to the pointer.
    pub(crate) fn follow(
        &mut self,
        ui: &Ui,
        rect: Rect,
        view: usize,
        response: &Response,
        zoom: Option<Zoom>,
        out: &mut Intents,
    ) {
        if self.tool == Tool::Navigate {
            self.stroke = None;
            return;
        }
        if response.contains_pointer() {
            ui.ctx().set_cursor_icon(CursorIcon::Crosshair);
        }
        self.lengthen(ui, view, response);
        let painter = ui.painter_at(rect);
        self.paint(&painter, view, response.hover_pos());
        let is_over = response.drag_stopped_by(PointerButton::Primary);
        let is_dab = self.tool == Tool::Brush && response.clicked();
        let is_held = response.is_pointer_button_down_on();
        // A press that was no drag draws nothing.
        let ended = self
            .stroke
            .take_if(|stroke| stroke.view == view && !is_held);
        let Some(stroke) = ended.filter(|_| is_over || is_dab) else {
            return;
        };
        let part = |place: &Pos2| {
            let part = part_of(rect, *place);
            zoom.map_or(part, |zoom| zoom.part_at(part))
        };
        let enlarged = zoom.map_or(1.0, |zoom| zoom.factor);
        let drawn = Drawn {
            view,
            tool: self.tool,
            places: stroke.places.iter().map(part).collect(),
            radius: self.brush_radius / rect.height().max(1.0) / enlarged,
        };
        out.push(CompareIntent::Activate(view));
        out.push(SelectIntent::Region(drawn, stroke.mode));
    }

    /// Begins a stroke when the button goes down, and takes over the pointer's places while it is held.
    fn lengthen(&mut self, ui: &Ui, view: usize, response: &Response) {
        let (begins, modifiers, origin) = ui.input(|input| {
            let pointer = &input.pointer;
            let begins = pointer.primary_pressed();
            (begins, input.modifiers, pointer.press_origin())
        });
        if begins && response.is_pointer_button_down_on() && !modifiers.alt {
            self.stroke = Some(Stroke {
                view,
                mode: mode_of(modifiers),
                places: origin.into_iter().collect(),
            });
        }
        let tool = self.tool;
        let Some(stroke) = self.stroke.as_mut().filter(|stroke| stroke.view == view) else {
            return;
        };
        if ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Escape)) {
            self.stroke = None;
            return;
        }
        // All places since the last pass: a fast hand draws a round line too.
        let moves = ui.input(|input| {
            let moves = input.events.iter().filter_map(|event| match event {
                Event::PointerMoved(place) => Some(*place),
                _ => None,
            });
            moves.collect::<Vec<Pos2>>()
        });
        for place in moves {
            let is_far = |last: &Pos2| last.distance(place) >= LEAST_STEP;
            match tool {
                Tool::Rectangle => {
                    stroke.places.truncate(1);
                    stroke.places.push(place);
                }
                _ if stroke.places.last().is_none_or(is_far) => stroke.places.push(place),
                _ => {}
            }
        }
    }

    fn paint(&self, painter: &Painter, view: usize, hovered: Option<Pos2>) {
        let stroke = self.stroke.as_ref().filter(|stroke| stroke.view == view);
        if self.tool == Tool::Brush
            && let Some(at) = hovered
        {
            paint_line(painter, |line| {
                Shape::circle_stroke(at, self.brush_radius, line)
            });
        }
        let Some(stroke) = stroke else { return };
        match (self.tool, stroke.places.as_slice()) {
            (Tool::Rectangle, [from, .., to]) => {
                let rect = Rect::from_two_pos(*from, *to);
                painter.rect_filled(rect, 0.0, FILL);
                paint_line(painter, |line| {
                    Shape::closed_line(
                        vec![
                            rect.left_top(),
                            rect.right_top(),
                            rect.right_bottom(),
                            rect.left_bottom(),
                        ],
                        line,
                    )
                });
            }
            (Tool::Lasso, places) => {
                paint_line(painter, |line| Shape::closed_line(places.to_vec(), line));
            }
            (Tool::Brush, places) => {
                let width = Line::new(self.brush_radius * 2.0, FILL);
                painter.add(Shape::line(places.to_vec(), width));
            }
            _ => {}
        }
    }
}

/// What is laid over what is being drawn.
const FILL: Color32 = Color32::from_rgba_premultiplied(46, 0, 29, 46);

/// A white line in a dark one: to be seen on every picture.
fn paint_line(painter: &Painter, shape: impl Fn(Line) -> Shape) {
    painter.add(shape(Line::new(3.0, Color32::from_black_alpha(150))));
    painter.add(shape(Line::new(1.2, Color32::WHITE)));
}

/// With Shift a region joins the selection, with Ctrl it leaves it.
fn mode_of(modifiers: egui::Modifiers) -> MarkMode {
    if modifiers.shift {
        MarkMode::Add
    } else if modifiers.command || modifiers.ctrl {
        MarkMode::Subtract
    } else {
        MarkMode::Replace
    }
}
