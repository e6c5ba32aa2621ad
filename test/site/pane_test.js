// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Runs in doc/pane.html, after EXPECTED of pane_values: compares its answers with the library's, then moves what can be moved and
// looks at the drawing. The last line of the page says what was wrong, or "passed".
"use strict";
{
  const problems = [], worst = {};
  window.addEventListener("error", (event) => problems.push(`error: ${event.message}`));

  //! Where the library has no answer (NaN), the page has null.
  const difference = (a, b) => {
    if (!a || a.length !== b.length) return a === null && b.every(Number.isNaN) ? 0 : Infinity;
    const d = Math.max(...b.map((value, k) => Math.abs(a[k] - value)));
    return Number.isNaN(d) ? Infinity : d;
  };
  // Pixels to 1e-9; lengths to the same share of about 10 mm, directions to rounding.
  const LIMITS = { pixel1: 1e-9, pixel2: 1e-9, pinhole1: 1e-9, pinhole2: 1e-9, curve: 1e-9, lineDistance: 1e-9,
    endDistance: 1e-6, origin: 1e-9, direction: 1e-12, ignored: 1e-8 };
  for (const expected of EXPECTED) {
    const answer = pane.compute({ ...expected.input, samples: 2 }) || {};
    const seen = { ...answer, ...answer.ray, curve: [] };
    // The library is as exact beside a line as this, beyond its end to what it promises.
    const distance = answer.ignored ? "lineDistance" : "endDistance";
    seen[distance] = [answer.lineDistance];
    expected[distance] = expected.distance;
    // A curve of one depth at a time, as the page spaces depths in its own way.
    for (let k = 0; k < expected.curve.length; k += 3) {
      const near = expected.curve[k], curve = pane.compute({ ...expected.input, near, far: 2*near, samples: 2 }).curve;
      seen.curve.push(...(curve.length === 2 ? [curve[0].z, ...curve[0].pixel] : [NaN, NaN, NaN]));
    }
    for (const key of Object.keys(LIMITS).filter((name) => name in expected))
      worst[key] = Math.max(worst[key] || 0, difference(seen[key], expected[key]));
  }
  for (const [key, limit] of Object.entries(LIMITS))
    if (!(worst[key] <= limit)) problems.push(`${key} is ${worst[key]} off the library's, more than ${limit}`);
  if (EXPECTED.length < 200) problems.push(`only ${EXPECTED.length} configurations`);
  if (pane.compute({ z: 50 }) !== null) problems.push("a point before the pane has an answer");

  // Every slider to both ends, both media: each moves the figure, and nothing that is not a number gets into it.
  const figures = () => [...document.querySelectorAll("figure svg")].map((svg) => svg.innerHTML).join();
  const look = (what, before) => {
    const now = figures();
    if (now === before) problems.push(`${what} changes no figure`);
    if (/NaN|Infinity|undefined/.test(now + document.querySelector("#numbers").textContent)) problems.push(`${what}: no number`);
  };
  for (const button of document.querySelectorAll("#behind button, #examples button")) {
    for (const input of document.querySelectorAll("#controls input"))
      for (const end of [input.min, input.max, input.value]) {
        const before = figures(), changes = input.value !== end;
        input.value = end;
        input.dispatchEvent(new Event("input"));
        look(`${input.name} = ${end}`, changes ? before : "");
      }
    button.click();
    look(button.textContent, "");
  }

  const line = document.createElement("pre");
  line.id = "result";
  line.textContent = [...Object.entries(worst).map(([key, value]) => `${key} ${value.toExponential(1)}`),
    ...problems.slice(0, 20), problems.length ? "failed" : "passed"].join("\n");
  document.body.append(line);
}
