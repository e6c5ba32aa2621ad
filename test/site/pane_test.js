// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Runs in doc/pane.html, after EXPECTED of pane_values: compares its answers with the library's, shape by shape, then moves what can be
// moved and looks at the drawing. The last line of the page says what was wrong, or "passed".
"use strict";
{
  const problems = [], worst = {}, counts = {};
  window.addEventListener("error", (event) => problems.push(`error: ${event.message}`));

  //! Where the library has no answer (NaN), the page has null.
  const difference = (a, b) => {
    if (!a || a.length !== b.length) return a === null && b.every(Number.isNaN) ? 0 : Infinity;
    const d = Math.max(...b.map((value, k) => Math.abs(a[k] - value)));
    return Number.isNaN(d) ? Infinity : d;
  };
  // Pixels to 1e-9; lengths to the same share of about 10 mm, directions to rounding.
  const LIMITS = { pixel1: 1e-9, pixel2: 1e-9, pinhole1: 1e-9, pinhole2: 1e-9, curve: 1e-9, lineDistance: 1e-9,
    endDistance: 1e-6, line: 1e-9, direction: 1e-12, ignored: 1e-8 };
  const note = (shape, key, d) => {
    worst[`${shape} ${key}`] = Math.max(worst[`${shape} ${key}`] || 0, d);
    if (!(d <= LIMITS[key])) problems.push(`${shape}: ${key} is ${d} off the library's, more than ${LIMITS[key]}`);
  };

  /* Where the camera is in the denser medium, and behind a caustic of the tube, a search may end without an answer (6), or tell total
  reflection (4) from that otherwise. What one of the two leaves open is not compared, but counted. */
  const NO_PATH = [4, 6], isOpen = (a, b) => a !== b && (a === 6 || b === 6);
  const compareStatus = (shape, statuses, expected) => expected.map((status, k) => {
    counts[`${shape} status ${status}`] = (counts[`${shape} status ${status}`] || 0) + 1;
    if (!isOpen(statuses[k], status)) {
      if (statuses[k] !== status) problems.push(`${shape}: status ${statuses[k]}, the library's is ${status}`);
      return true;
    }
    counts[`${shape} left open`] = (counts[`${shape} left open`] || 0) + 1;
    return NO_PATH.includes(statuses[k]) && NO_PATH.includes(status);
  }).every(Boolean);

  //! By how much a line misses a point.
  const beside = (ray, point) => {
    const way = point.map((v, k) => v - ray.origin[k]), d = ray.direction;
    return Math.hypot(way[1]*d[2] - way[2]*d[1], way[2]*d[0] - way[0]*d[2], way[0]*d[1] - way[1]*d[0]);
  };
  // Far points move in proportion to the square of their distance.
  const FAR = 1000, farness = (point) => point ? Math.max(1, (Math.hypot(...point)/FAR)**2) : 1;
  for (const expected of EXPECTED) {
    const shape = expected.input.shape, answer = pane.compute({ ...expected.input, depths: expected.depths || [] });
    for (const key of ["pinhole1", "pinhole2"]) note(shape, key, difference(answer[key], expected[key]));
    if (!compareStatus(shape, [answer.status1, answer.status2], expected.status)) continue;
    for (const key of ["pixel1", "pixel2"]) note(shape, key, difference(answer[key], expected[key]));
    // Rays that are parallel but for rounding meet anywhere.
    if (!(Math.hypot(...expected.ignored) > 1e9))
      note(shape, "ignored", difference(answer.ignored, expected.ignored)/farness(answer.ignored));
    // The library is as exact beside a line as this, beyond its end to what it promises.
    if (answer.lineDistance !== null)
      note(shape, answer.ignored ? "lineDistance" : "endDistance", difference([answer.lineDistance], expected.distance));
    // A shape's own search has the answer, but of a tube that holds the denser medium: else it is broken, and this hides it.
    for (const seen of [answer.seen1, answer.seen2])
      if (seen.attempts > 0 && !(shape === "tube" && expected.input.innerIndex > 1))
        problems.push(`${shape}: ${seen.attempts} attempts without an answer`);
    if (!expected.origin) continue;
    note(shape, "line", beside(answer.seen1, expected.origin));
    note(shape, "direction", difference(answer.seen1.direction, expected.direction));
    for (const [k, at] of answer.curve.entries())
      if (compareStatus(`${shape} curve`, [at.status], [expected.curveStatus[k]]))
        note(shape, "curve", difference(at.pixel, expected.curve.slice(2*k, 2*k + 2)));
  }
  for (const shape of ["flat", "dome", "tube"]) {
    const total = EXPECTED.filter((expected) => expected.input.shape === shape).length;
    if (total < 200) problems.push(`only ${total} configurations of ${shape}`);
    for (const name of [`${shape} left open`, `${shape} curve left open`])
      if (counts[name] > 0.02*total) problems.push(`${name}: ${counts[name]} of ${total}`);
    for (const key of Object.keys(LIMITS))
      if (!(`${shape} ${key}` in worst)) problems.push(`${shape}: no ${key} was compared`);
  }
  for (const [what, given, status] of [
    ["a point before the pane", { z: 50 }, 3],
    ["a point in the glass of a dome", { shape: "dome", centerX: 0, centerY: 0, centerZ: 0, x: 0, y: 0, z: 70 }, 3],
    ["a point in a tube", { shape: "tube", turn: 0, lean: 0, x: 150, y: 0, z: 30 }, 3],
    ["a camera outside its dome", { shape: "dome", radius: 20, centerX: 30 }, -1],
    ["a camera outside its tube", { shape: "tube", radius: 20, beside: 30 }, -1],
    ["total reflection in a ball of water", { shape: "dome", innerIndex: 1.333, centerX: -20, centerY: 5, centerZ: 50, radius: 70,
      thickness: 2, x: 350, y: -60, z: 600 }, 4]])
    if (pane.compute(given).status1 !== status) problems.push(`${what} has the status ${pane.compute(given).status1}, not ${status}`);

  // Every slider to both ends, all media: each moves the figures of some example, and nothing that is not a number gets into one.
  const visible = (selector) => [...document.querySelectorAll(selector)].filter((element) => !element.closest("[hidden]"));
  // Without the numbers of clips, which are new in each drawing.
  const figures = () => visible("figure svg").map((svg) => svg.innerHTML.replace(/clip\d+/g, "")).join();
  const look = (what) => {
    const numbers = document.querySelector("#numbers").textContent + document.querySelector("#loupe-caption").textContent;
    if (/NaN|Infinity|undefined|null/.test(figures() + numbers)) problems.push(`${what}: no number`);
  };
  const click = (button) => {
    button.click();
    look(button.textContent);
  };
  const moveSliders = (name, moving) => {
    for (const input of visible("#controls input"))
      for (const end of [input.min, input.max, input.value]) {
        const before = figures();
        input.value = end;
        input.dispatchEvent(new Event("input"));
        look(`${name}: ${input.name} = ${end}`);
        if (figures() !== before) moving.add(input.name);
      }
  };
  let examples = 0;
  for (const shape of document.querySelectorAll("[data-key=shape]")) {
    click(shape);
    const moving = new Set();
    for (const button of visible("#examples button")) {
      click(button);
      examples++;
      for (const medium of visible("[data-key=innerIndex], [data-key=outerIndex]")) click(medium);
      click(button);
      moveSliders(button.textContent, moving);
    }
    for (const input of visible("#controls input"))
      if (!moving.has(input.name)) problems.push(`${shape.textContent}: ${input.name} changes no figure`);
  }
  if (examples < 14) problems.push(`only ${examples} examples`);

  const line = document.createElement("pre");
  line.id = "result";
  line.textContent = [`seed ${SEED}`, ...Object.entries(worst).map(([key, value]) => `${key} ${value.toExponential(1)}`),
    ...Object.entries(counts).map(([key, value]) => `${key}: ${value}`),
    ...problems.slice(0, 20), problems.length ? "failed" : "passed"].join("\n");
  document.body.append(line);
}
