"use strict";
// The workspace, to be turned: drag, arrow keys, buttons. Coordinates in mm.
document.querySelectorAll(".view").forEach((view) => {
  const data = JSON.parse(view.dataset.rows);
  const svg = view.querySelector("svg");
  const say = view.querySelector("output");
  const make = (name, kind) => {
    const made = svg.appendChild(document.createElementNS(svg.namespaceURI, name));
    made.setAttribute("class", kind);
    return made;
  };
  const home = { turn: -0.9, tilt: 0.45, zoom: 1 };
  const at = { ...home };
  const low = [0, 1, 2].map((k) => Math.min(0, ...data.points.map((p) => p[k])));
  const high = [0, 1, 2].map((k) => Math.max(0, ...data.points.map((p) => p[k])));
  const middle = low.map((l, k) => (l + high[k]) / 2);
  const size = Math.max(1, Math.hypot(...low.map((l, k) => high[k] - l)));
  let times = data.times;

  // From mm to the drawing; the third number is how near it is.
  const flat = (p) => {
    const x = p[0] - middle[0];
    const y = p[1] - middle[1];
    const z = p[2] - middle[2];
    const [c, s] = [Math.cos(at.turn), Math.sin(at.turn)];
    const away = s * x + c * y;
    const scale = (680 * at.zoom) / size;
    const up = z * Math.cos(at.tilt) + away * Math.sin(at.tilt);
    return [500 + scale * (c * x - s * y), 350 - scale * up, -away];
  };
  const pen = (a, b) => `M${a[0].toFixed(1)} ${a[1].toFixed(1)}L${b[0].toFixed(1)} ${b[1].toFixed(1)}`;

  // The box around everything, with its extents; the base with its axes.
  const box = make("path", "edge");
  const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [0, 1, 2].map((k) => ((i >> k) % 2 ? high : low)[k]));
  const edges = [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]];
  const extents = ["x", "y", "z"].map(() => make("text", "halo"));
  const ends = [1, 2, 4];
  const base = ["i1", "i2", "i0"].map((ink) => make("path", "line " + ink));
  base.forEach((axis) => axis.setAttribute("stroke-width", "3"));
  const letters = ["x", "y", "z"].map((letter) => {
    const text = make("text", "halo");
    text.textContent = letter;
    return text;
  });

  const kinds = [
    { name: "before", errors: data.before, ink: "i1" },
    { name: "after", errors: data.after, ink: "i0" },
  ].filter((kind) => kind.errors.length);
  kinds.forEach((kind) => {
    kind.path = make("path", "thin " + kind.ink);
    kind.path.dataset.marks = kind.errors.length;
    kind.shown = view.querySelector("input." + kind.name);
    kind.shown.addEventListener("change", draw);
  });
  const dots = make("path", "dots " + (kinds.length ? "i6" : "i0"));
  dots.dataset.marks = data.points.length;
  const mark = make("circle", "thin i3");
  mark.setAttribute("r", "0");
  let seen = [];

  function draw() {
    seen = data.points.map(flat);
    dots.setAttribute("d", seen.map((p) => `M${p[0].toFixed(1)} ${p[1].toFixed(1)}h0`).join(""));
    kinds.forEach((kind) => {
      const arrow = (e, i) => pen(seen[i], flat(data.points[i].map((p, k) => p + times * e[k])));
      kind.path.setAttribute("d", kind.errors.map(arrow).join(""));
      kind.path.style.display = kind.shown.checked ? "" : "none";
    });
    const placed = corners.map(flat);
    box.setAttribute("d", edges.map((e) => pen(placed[e[0]], placed[e[1]])).join(""));
    const taken = [];
    extents.forEach((text, k) => {
      const [a, b] = [placed[0], placed[ends[k]]];
      text.textContent = `${"xyz"[k]} ${low[k].toFixed(0)} to ${high[k].toFixed(0)} mm`;
      text.setAttribute("text-anchor", "middle");
      const x = Math.min(890, Math.max(110, (a[0] + b[0]) / 2));
      let y = Math.min(690, Math.max(20, (a[1] + b[1]) / 2 + 16));
      // Seen from above or from a side an extent is a point: none on another.
      const way = y < 350 ? 18 : -18;
      const over = (p) => Math.abs(p[0] - x) < 220 && Math.abs(p[1] - y) < 18;
      while (taken.some(over)) y += way;
      taken.push([x, y]);
      text.setAttribute("x", x);
      text.setAttribute("y", y);
    });
    const origin = flat([0, 0, 0]);
    base.forEach((axis, k) => {
      const end = flat([0, 1, 2].map((i) => (i === k ? 0.12 * size : 0)));
      axis.setAttribute("d", pen(origin, end));
      letters[k].setAttribute("x", end[0] + 4);
      letters[k].setAttribute("y", end[1] - 4);
    });
    mark.setAttribute("r", "0");
  }

  // Whatever is nearest to the pointer, in words.
  const length = (e) => `${Math.hypot(...e).toFixed(3)} mm`;
  function point(event) {
    const matrix = svg.getScreenCTM();
    const place = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse());
    let best = -1;
    let least = 400;
    seen.forEach((p, i) => {
      const far = (p[0] - place.x) ** 2 + (p[1] - place.y) ** 2;
      best = least > far ? i : best;
      least = Math.min(least, far);
    });
    mark.setAttribute("r", best === -1 ? "0" : "7");
    if (best === -1) return;
    mark.setAttribute("cx", seen[best][0]);
    mark.setAttribute("cy", seen[best][1]);
    const errors = kinds.map((kind) => `${kind.name} ${length(kind.errors[best])}`).join(", ");
    const where = data.points[best].map((p) => p.toFixed(0)).join(", ");
    say.textContent = `${data.what} ${data.rows[best]} at ${where} mm${errors ? ": " : ""}${errors}`;
  }

  let held = null;
  svg.addEventListener("pointerdown", (event) => {
    held = [event.clientX, event.clientY];
    svg.setPointerCapture(event.pointerId);
  });
  svg.addEventListener("pointermove", (event) => {
    if (!held) return point(event);
    at.turn -= (event.clientX - held[0]) / 150;
    at.tilt = Math.max(-1.57, Math.min(1.57, at.tilt + (event.clientY - held[1]) / 150));
    held = [event.clientX, event.clientY];
    requestAnimationFrame(draw);
  });
  ["pointerup", "pointercancel"].forEach((name) => svg.addEventListener(name, () => { held = null; }));
  const moves = {
    ArrowLeft: () => { at.turn += 0.1; },
    ArrowRight: () => { at.turn -= 0.1; },
    ArrowUp: () => { at.tilt = Math.min(1.57, at.tilt + 0.1); },
    ArrowDown: () => { at.tilt = Math.max(-1.57, at.tilt - 0.1); },
    "+": () => { at.zoom *= 1.2; },
    "-": () => { at.zoom /= 1.2; },
    above: () => Object.assign(at, { turn: 0, tilt: 1.5707 }),
    front: () => Object.assign(at, { turn: 0, tilt: 0 }),
    side: () => Object.assign(at, { turn: -1.5708, tilt: 0 }),
    back: () => Object.assign(at, home),
    longer: () => { times *= 1.5; },
    shorter: () => { times /= 1.5; },
  };
  const move = (name) => {
    moves[name]();
    say.textContent = data.times === 1 ? "" : `errors drawn ${times.toFixed(0)} times`;
    draw();
  };
  svg.addEventListener("keydown", (event) => {
    if (!(event.key in moves)) return;
    event.preventDefault();
    move(event.key);
  });
  view.querySelectorAll("button").forEach((button) => {
    button.addEventListener("click", () => move(button.value));
  });
  draw();
});
