// The two pictures on the stage are copies of pictures that stand further down, so that nothing is in the page twice.
"use strict";
const byId = (id) => document.getElementById(id);
const stage = byId("stage"), cut = byId("cut"), view = byId("view");
const sides = { left: byId("left"), right: byId("right") };
const find = (view, key) =>
  [...document.querySelectorAll("img[data-key]")].find((img) => img.dataset.view === view && img.dataset.key === key);

function show() {
  for (const [side, select] of Object.entries(sides)) {
    const source = find(view.value, select.value), shown = byId("shown-" + side);
    if (source) {
      shown.src = source.src;
      shown.alt = source.alt;
    }
    byId("tag-" + side).textContent = select.selectedOptions[0].textContent;
  }
}

function move() {
  stage.style.setProperty("--cut", cut.value + "%");
}

function point(event) {
  const box = byId("pair").getBoundingClientRect();
  cut.value = (100 * (event.clientX - box.left)) / box.width;
  move();
}

byId("pair").addEventListener("pointerdown", (event) => {
  byId("pair").setPointerCapture(event.pointerId);
  point(event);
});
byId("pair").addEventListener("pointermove", (event) => {
  if (event.buttons) point(event);
});
cut.addEventListener("input", move);
for (const select of [view, sides.left, sides.right]) select.addEventListener("change", show);
byId("zoom").addEventListener("change", () => stage.style.setProperty("--zoom", byId("zoom").value));
byId("swap").addEventListener("click", () => {
  [sides.left.value, sides.right.value] = [sides.right.value, sides.left.value];
  show();
});
document.addEventListener("click", (event) => {
  const img = event.target.closest("button.shot")?.querySelector("img[data-key]");
  if (!img) return;
  view.value = img.dataset.view;
  sides.right.value = img.dataset.key;
  show();
  stage.scrollIntoView({ block: "nearest" });
});
byId("look").hidden = false;
show();
move();
