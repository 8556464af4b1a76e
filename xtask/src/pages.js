// At the end of a page: are the marks that are drawn those that the data have, and does
// the page fit the window? One line on the console where they are and it does.
addEventListener("load", () => {
  const wrong = [];
  const own = (series, kind) =>
    [...series.querySelectorAll("path, rect")].filter((e) => e.classList.contains(kind));
  const pens = (series, kind, pen) =>
    own(series, kind).reduce((n, e) => n + (e.getAttribute("d").match(pen) || []).length, 0);
  let all = 0;
  let series = 0;
  const compare = (what, said, drawn) => {
    series += 1;
    all += drawn;
    if (said !== drawn || said === 0) wrong.push(`${what}: ${said} in the data, ${drawn} drawn`);
  };
  document.querySelectorAll("g[data-marks]").forEach((g) => {
    const shapes = ["shape", "tread", "bar"].reduce((n, kind) => n + own(g, kind).length, 0);
    const bands = pens(g, "band", /[ML]/g) / 2;
    const arrows = shapes ? 0 : pens(g, "thin", /M/g);
    const drawn = shapes + pens(g, "dots", /M/g) + pens(g, "line", /[ML]/g) + bands + arrows;
    compare(g.closest("figure").id, Number(g.dataset.marks), drawn);
  });
  document.querySelectorAll(".view").forEach((view) => {
    const data = JSON.parse(view.dataset.rows);
    const drawn = [...view.querySelectorAll("svg path[data-marks]")];
    const errors = [data.before, data.after].filter((rows) => rows.length);
    const expected = [...errors, data.points].map((rows) => rows.length);
    if (drawn.length !== expected.length) wrong.push("view: a kind of mark is missing");
    drawn.forEach((path, k) => compare("view", expected[k], path.getAttribute("d").match(/M/g).length));
  });
  const wide = document.documentElement.scrollWidth;
  if (wide > innerWidth) wrong.push(`${wide} px wide in a window of ${innerWidth}`);
  if (series === 0) wrong.push("nothing is drawn");
  if (wrong.length) console.error(wrong.join("; "));
  else console.log(`as in the data: ${all} marks of ${series} series`);
});
