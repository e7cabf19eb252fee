// Reads out the lines of a chart at the pointer. Everything is in the drawing already.
(function () {
  var box = document.createElement("div");
  box.className = "readout";
  document.body.appendChild(box);
  document.querySelectorAll("svg[data-x]").forEach(function (svg) {
    var x = svg.dataset.x.split(" ").map(Number), y = svg.dataset.y.split(" ").map(Number);
    var log = svg.dataset.log === "true", cursor = svg.querySelector(".cursor");
    var lines = Array.from(svg.querySelectorAll("path[data-label]")).map(function (path) {
      var points = (path.getAttribute("d").match(/[-\d.]+ [-\d.]+/g) || []).map(function (p) {
        return p.split(" ").map(Number);
      });
      return { label: path.dataset.label, points: points };
    });
    svg.addEventListener("pointermove", function (event) {
      var at = svg.createSVGPoint();
      at.x = event.clientX; at.y = event.clientY;
      var px = at.matrixTransform(svg.getScreenCTM().inverse()).x;
      px = Math.max(x[2], Math.min(x[3], px));
      var rows = [(x[0] + (px - x[2]) / (x[3] - x[2]) * (x[1] - x[0])).toFixed(2)];
      lines.forEach(function (line) {
        var best = line.points.reduce(function (a, b) {
          return Math.abs(a[0] - px) > Math.abs(b[0] - px) ? b : a;
        }, [Infinity, NaN]);
        var part = (best[1] - y[2]) / (y[3] - y[2]);
        var value = log ? y[0] * Math.pow(y[1] / y[0], part) : y[0] + part * (y[1] - y[0]);
        if (isFinite(value)) { rows.push(line.label + "  " + value.toPrecision(3)); }
      });
      cursor.setAttribute("x1", px); cursor.setAttribute("x2", px);
      cursor.style.opacity = 1;
      box.textContent = rows.join("\n");
      box.style.display = "block";
      box.style.left = Math.min(event.clientX + 14, window.innerWidth - 230) + "px";
      box.style.top = event.clientY + 14 + "px";
    });
    svg.addEventListener("pointerleave", function () {
      cursor.style.opacity = 0;
      box.style.display = "none";
    });
  });
})();
