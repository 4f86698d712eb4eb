//! `report.html` in a browser: pictures load, the slider moves, nothing is asked of the network, and a phone shows it.

use std::path::Path;

use anyhow::{Context as _, Result};
use pointstage_tests::data::{repository, sample, skip};
use pointstage_tests::{browser, golden};
use serde_json::Value;

use super::Shell;

/// Goes into the page before its own script: hears of all that goes wrong.
const LISTEN: &str = "<script>
window.wrong = [];
addEventListener('error', (e) => wrong.push('error: ' + (e.message || e.target)), true);
addEventListener('unhandledrejection', (e) => wrong.push('rejected: ' + e.reason));
addEventListener('securitypolicyviolation', (e) => wrong.push('blocked: ' + e.blockedURI));
console.error = (...words) => wrong.push('console: ' + words.join(' '));
</script>";

/// Goes behind it: uses the page as a person does, and tells the page around it what came of it.
const PROBE: &str = "<script>
addEventListener('load', async () => {
  const images = [...document.images];
  await Promise.all(images.map((image) => image.decode().catch(() => {})));
  const by = (id) => document.getElementById(id);
  const clip = () => getComputedStyle(by('shown-right')).clipPath;
  const found = { width: innerWidth, needed: document.documentElement.scrollWidth };
  found.images = images.length;
  found.empty = images.filter((image) => !image.naturalWidth).length;
  found.foreign = images.filter((image) => !image.src.startsWith('data:')).length;
  found.clip = [clip()];
  by('cut').value = 25;
  by('cut').dispatchEvent(new Event('input'));
  found.clip.push(clip());
  const box = by('pair').getBoundingClientRect();
  const at = { clientX: box.left + 0.75 * box.width, clientY: box.top + 5, pointerId: 1, buttons: 1, bubbles: true };
  by('pair').setPointerCapture = () => {};
  by('pair').dispatchEvent(new PointerEvent('pointerdown', at));
  found.clip.push(clip());
  found.focusable = by('cut').tabIndex === 0 && by('cut').type === 'range';
  by('view').value = '1';
  by('view').dispatchEvent(new Event('change'));
  const source = (key) => document.querySelector('img[data-view=\"1\"][data-key=\"' + key + '\"]').src;
  found.second = by('shown-left').src === source('reference') && by('shown-right').src === source('picture-0');
  document.querySelector('img[data-view=\"0\"][data-key=\"difference-0\"]').closest('button').click();
  found.clicked = by('view').value === '0' && by('right').value === 'difference-0';
  found.numbers = getComputedStyle(document.querySelector('td.n')).textAlign;
  found.requests = performance.getEntriesByType('resource').map((entry) => entry.name).filter((name) => !name.startsWith('data:'));
  found.wrong = [...wrong];
  found.fetched = await fetch('https://example.invalid/').then(() => 'sent', () => 'refused');
  await new Promise((resolve) => setTimeout(resolve, 50));
  found.refusals = wrong.length - found.wrong.length;
  parent.postMessage(JSON.stringify(found), '*');
});
</script>";

/// The page in two frames: as wide as a desk's window, and as a phone.
const AROUND: &str = "<!DOCTYPE html><html><body>
<script>addEventListener('message', (e) => console.log('found ' + e.data));</script>
<iframe src='probed.html' width=1100 height=800></iframe><iframe src='probed.html' width=375 height=800></iframe>
</body></html>";

/// Opens the page in both widths; what each told.
fn probed(browser: &Path, folder: &Path) -> Result<Vec<Value>> {
    let page = std::fs::read_to_string(folder.join("report.html"))?;
    let page = page.replacen("<body>", &format!("<body>{LISTEN}"), 1);
    let page = page.replacen("</body>", &format!("{PROBE}</body>"), 1);
    std::fs::write(folder.join("probed.html"), page)?;
    std::fs::write(folder.join("around.html"), AROUND)?;
    let told = browser::told(browser, &folder.join("around.html"), folder, "found ", 2)?;
    let told = told.iter();
    told.map(|text| serde_json::from_str(text).with_context(|| text.clone()))
        .collect()
}

#[test]
fn the_report_works_in_a_browser_on_a_desk_and_on_a_phone() -> Result<()> {
    let Some(browser) = browser::find() else {
        skip("no Chromium to open the report in");
        return Ok(());
    };
    let shell = Shell::new()?;
    // A name that would end its element, if anything let it.
    let name = "a<b>&'c\".ply";
    std::fs::rename(shell.folder().join("sphere.ply"), shell.folder().join(name))?;
    let line = format!(
        "compare {name} --no-device --renderers fallback,ewa-reference --reference ewa-reference:samples=2 --views orbit:2 \
         --targets all --size 96x64 --frames 2 --out apart"
    );
    let finished = shell.run(&line)?;
    assert_eq!(finished.code(), Some(0), "{}", finished.stderr);
    let found = probed(&browser, &shell.folder().join("apart"))?;
    for found in &found {
        let said = format!("{found:#}");
        let count = |key: &str| found[key].as_u64().with_context(|| said.clone());
        // Per view the reference, two pictures, four maps, and targets; and the two on the stage.
        assert!(count("images")? > 2 * 7 + 2, "{said}");
        assert_eq!((count("empty")?, count("foreign")?), (0, 0), "{said}");
        let clips = ["50%", "25%", "75%"].map(|cut| format!("inset(0px 0px 0px {cut})"));
        assert_eq!(found["clip"], serde_json::json!(clips), "{said}");
        for key in ["focusable", "second", "clicked"] {
            assert_eq!(found[key], true, "{key}: {said}");
        }
        assert_eq!(found["numbers"], "right", "{said}");
        assert_eq!(found["requests"], serde_json::json!([]), "{said}");
        assert_eq!(found["wrong"], serde_json::json!([]), "{said}");
        // The page's own policy keeps a script from the network.
        assert_eq!(found["fetched"], "refused", "{said}");
        assert!(count("refusals")? >= 1, "{said}");
        assert!(
            count("needed")? <= count("width")?,
            "it scrolls sideways: {said}"
        );
    }
    let mut widths: Vec<u64> = found
        .iter()
        .filter_map(|found| found["width"].as_u64())
        .collect();
    widths.sort_unstable();
    assert_eq!(widths, [375, 1100]);
    Ok(())
}

/// Size of the README's picture, px: down to the slider.
const PICTURE_PX: [u32; 2] = [1160, 1390];

#[test]
fn the_report_is_shown_in_the_readme() -> Result<()> {
    if std::env::var_os("POINTSTAGE_PICTURES").is_none() {
        return Ok(());
    }
    let browser = browser::find().context("the picture of a report needs Chromium")?;
    let shell = Shell::new()?;
    let line = format!(
        "compare {} --renderers hqss,surfel,points --reference ewa-reference --views orbit:6 --frames 3 --out apart",
        sample("knotted_snake.ply").display()
    );
    let finished = shell.run(&line)?;
    assert_eq!(finished.code(), Some(0), "{}", finished.stderr);
    let page = shell.folder().join("apart/report.html");
    let mut shown = browser::picture(&browser, &page, shell.folder(), PICTURE_PX)?;
    // Five bits a channel: it looks the same, and the file has half the size.
    for channel in shown.pixels_mut().flat_map(|pixel| &mut pixel.0[..3]) {
        *channel = *channel & 0xF8 | *channel >> 5;
    }
    golden::write(&shown, &repository().join("docs/pictures/report.png"))
}
