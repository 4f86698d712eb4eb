use super::*;
use pointstage_scene::{Estimation, LoadOptions};

const POSITION: LoadColumnRecord<'static> = LoadColumnRecord {
    role: BorderRole::POSITION,
    scalar: BorderScalar::F32,
    components: 3,
    name: RStr::empty(),
};

fn rows<'a>(count: u64, columns: &'a [RSlice<'a, u8>]) -> LoadRowsRecord<'a> {
    LoadRowsRecord {
        count,
        columns: RSlice::from_slice(columns),
    }
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
    let options = LoadOptions {
        estimation: Estimation::FileOnly,
        ..LoadOptions::default()
    };
    let contents = sink.into_builder().unwrap().finish(&options, &job).unwrap();
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
    let cases: [(Act<'_>, &str); 7] = [
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
    ];
    for (act, part) in cases {
        let problem = broken(act);
        assert!(problem.contains(part), "{part}: {problem}");
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
