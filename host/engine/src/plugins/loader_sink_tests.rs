use super::*;
use pointstage_scene::{Contents, Estimation, LoadOptions};

const POSITION: LoadColumnRecord<'static> = LoadColumnRecord {
    role: BorderRole::POSITION,
    scalar: BorderScalar::F32,
    components: 3,
    name: RStr::empty(),
};

const CENTIMETRES: LoadScaleRecord = LoadScaleRecord {
    scale: [0.01; 3],
    offset: [600_000.0, 0.0, -5.0],
};

fn rows<'a>(count: u64, columns: &'a [RSlice<'a, u8>]) -> LoadRowsRecord<'a> {
    LoadRowsRecord {
        count,
        columns: RSlice::from_slice(columns),
    }
}

/// What was handed over, with nothing estimated.
fn contents_of(sink: Sink<'_>, job: &Job) -> Contents {
    let options = LoadOptions {
        estimation: Estimation::FileOnly,
        ..LoadOptions::default()
    };
    sink.into_builder().unwrap().finish(&options, job).unwrap()
}

#[test]
fn columns_polygons_and_warnings_become_an_object() {
    let job = Job::new();
    let sink = Sink::new(&job, 1 << 20);
    let border = sink.border();
    border.columns([POSITION][..].into(), 4).unwrap();
    let positions: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
    let bytes: Vec<u8> = positions
        .iter()
        .flat_map(|value| value.to_ne_bytes())
        .collect();
    border.rows(&rows(4, &[bytes.as_slice().into()])).unwrap();
    border
        .polygons([4][..].into(), [0, 1, 2, 3][..].into())
        .unwrap();
    border
        .polygons([][..].into(), [0, 1, 2][..].into())
        .unwrap();
    border.warn("a strange record".into(), 2);
    border.warn("a strange record".into(), 3);
    drop(border);
    let contents = contents_of(sink, &job);
    assert_eq!(contents.geometry.surfel_count, 4);
    assert_eq!(contents.geometry.triangles.unwrap().len(), 3);
    let kind = WarningKind::Other("a strange record".into());
    assert_eq!(contents.warnings.count(&kind), 5);
}

#[test]
fn what_breaks_the_rules_is_refused_and_remembered() {
    type Act<'t> = &'t dyn Fn(&LoadSinkRef<'_>);
    let broken = |act: Act<'_>| {
        let job = Job::new();
        let sink = Sink::new(&job, 1 << 20);
        let border = sink.border();
        act(&border);
        drop(border);
        sink.into_builder().expect_err("the rules were broken")
    };
    let short = [0_u8; 11];
    let cases: [(Act<'_>, &str); 9] = [
        (&|_: &LoadSinkRef<'_>| (), "without declaring"),
        (
            &|sink| drop(sink.rows(&rows(1, &[short[..].into()]))),
            "before it declared",
        ),
        (
            &|sink| {
                sink.columns([POSITION][..].into(), u64::MAX).unwrap();
                assert!(sink.rows(&rows(1, &[short[..].into()])).is_err());
                // Going on as if nothing had happened does not help.
                sink.rows(&rows(0, &[[][..].into()])).unwrap();
            },
            "take 12 bytes, got 11",
        ),
        (
            &|sink| {
                sink.columns([POSITION][..].into(), 0).unwrap();
                drop(sink.rows(&rows(u64::MAX, &[short[..].into()])));
            },
            "more than",
        ),
        (
            &|sink| {
                drop(
                    sink.columns(
                        [LoadColumnRecord {
                            role: BorderRole(99),
                            ..POSITION
                        }][..]
                            .into(),
                        0,
                    ),
                );
            },
            "does not know",
        ),
        (
            &|sink| {
                drop(
                    sink.columns(
                        [LoadColumnRecord {
                            scalar: BorderScalar::I64,
                            ..POSITION
                        }][..]
                            .into(),
                        0,
                    ),
                );
            },
            "no column can have",
        ),
        (
            &|sink| {
                sink.columns([POSITION][..].into(), 0).unwrap();
                drop(sink.polygons([][..].into(), [1, 2][..].into()));
            },
            "make no triangles",
        ),
        (
            &|sink| {
                sink.columns([POSITION][..].into(), 0).unwrap();
                drop(sink.scaled_positions(&CENTIMETRES));
            },
            "after its columns",
        ),
        (
            &|sink| {
                sink.scaled_positions(&CENTIMETRES).unwrap();
                drop(sink.columns([POSITION][..].into(), 0));
            },
            "whole numbers of 32 bits, found F32",
        ),
    ];
    for (act, part) in cases {
        let problem = broken(act);
        assert!(problem.contains(part), "{part}: {problem}");
    }
}

#[test]
fn whole_numbers_stand_for_positions() {
    let job = Job::new();
    let sink = Sink::new(&job, 1 << 20);
    let border = sink.border();
    border.scaled_positions(&CENTIMETRES).unwrap();
    let numbers = LoadColumnRecord {
        scalar: BorderScalar::I32,
        ..POSITION
    };
    border.columns([numbers][..].into(), 2).unwrap();
    let bytes: Vec<u8> = [1_i32, 2, 3, -4, 500, 6]
        .iter()
        .flat_map(|value| value.to_ne_bytes())
        .collect();
    border.rows(&rows(2, &[bytes.as_slice().into()])).unwrap();
    drop(border);
    let contents = contents_of(sink, &job);
    let bounds = contents.geometry.bounds;
    let (low, high) = (contents.origin + bounds.min, contents.origin + bounds.max);
    let expected = [599_999.96, 0.02, -4.97, 600_000.01, 5.0, -4.94];
    for (found, expected) in [low.x, low.y, low.z, high.x, high.y, high.z]
        .into_iter()
        .zip(expected)
    {
        assert!((found - expected).abs() < 1e-6, "{found}, not {expected}");
    }
}

#[test]
fn a_loader_that_begins_again_leaves_nothing_of_before() {
    let job = Job::new();
    let sink = Sink::new(&job, 1 << 20);
    let border = sink.border();
    border.begin_again().unwrap();
    border.scaled_positions(&CENTIMETRES).unwrap();
    let numbers = LoadColumnRecord {
        scalar: BorderScalar::I32,
        ..POSITION
    };
    border.columns([numbers][..].into(), 2).unwrap();
    border.rows(&rows(1, &[[7; 12][..].into()])).unwrap();
    border.warn("a strange record".into(), 2);
    border.columns([numbers][..].into(), 2).unwrap_err();
    border.begin_again().unwrap();
    border.columns([POSITION][..].into(), 2).unwrap();
    border.rows(&rows(2, &[[0; 24][..].into()])).unwrap();
    drop(border);
    let contents = contents_of(sink, &job);
    assert_eq!(contents.geometry.surfel_count, 2);
    assert!(contents.geometry.bounds.size() == glam::DVec3::ZERO && contents.warnings.is_empty());
}

#[test]
fn a_file_is_released_as_far_as_its_surfels_came() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("points");
    let bytes: Vec<u8> = (0..9 << 20).map(|index| (index % 251) as u8).collect();
    std::fs::write(&path, &bytes).unwrap();
    let file = SourceFile::open(&path).unwrap();
    let job = Job::new();
    for (expected, released) in [(9, [0, 4, 4, 8, 8]), (5, [0, 7, 7, 7, 7]), (0, [0; 5])] {
        let sink = Sink::of(&job, &file);
        let border = sink.border();
        border.columns([POSITION][..].into(), expected).unwrap();
        let found = [1, 3, 1, 3, 2].map(|count| {
            let positions = vec![0; 12 * count as usize];
            let columns = [positions.as_slice().into()];
            border.rows(&rows(count, &columns)).unwrap();
            sink.state.lock().unwrap().released >> 20
        });
        assert_eq!(found, released, "{expected} announced");
        assert!(file.bytes() == bytes, "{expected} announced");
    }
}

#[test]
fn a_cancelled_load_answers_so_at_every_call() {
    let job = Job::new();
    let sink = Sink::new(&job, 1 << 20);
    job.cancel();
    let call = JobCall::new(&job);
    assert_eq!(call.border().should_stop(), 1);
    let answer = sink.border().columns([POSITION][..].into(), 0);
    assert_eq!(answer.unwrap_err().code, ErrorCode::CANCELLED);
}
