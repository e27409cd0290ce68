// Shows the numbers of a chart at the place of the pointer, in the column of the legend that is empty else.
for (const figure of document.querySelectorAll(".chart")) {
  const chart = JSON.parse(figure.querySelector("script").textContent);
  const svg = figure.querySelector("svg"), mark = svg.querySelector(".mark");
  const cells = [...figure.querySelectorAll("td.now")], head = figure.querySelector("th.now");
  const nearest = (value) => {
    let low = 0, high = chart.x.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (chart.x[middle] > value) high = middle; else low = middle;
    }
    return value - chart.x[low] > chart.x[high] - value ? high : low;
  };
  svg.addEventListener("pointermove", (event) => {
    const box = svg.getBoundingClientRect(), inside = (event.clientX - box.left) / box.width * chart.width;
    const row = nearest(chart.from + (inside - chart.left) / (chart.right - chart.left) * (chart.to - chart.from));
    const place = chart.left + (chart.x[row] - chart.from) / (chart.to - chart.from) * (chart.right - chart.left);
    mark.setAttribute("transform", `translate(${place} 0)`);
    mark.style.visibility = "visible";
    head.textContent = `${chart.label}: ${chart.x[row]}`;
    cells.forEach((cell, k) => { cell.textContent = chart.lines[k][row] ?? "-"; });
  });
  svg.addEventListener("pointerleave", () => {
    mark.style.visibility = "hidden";
    head.textContent = "";
    cells.forEach((cell) => { cell.textContent = ""; });
  });
}
