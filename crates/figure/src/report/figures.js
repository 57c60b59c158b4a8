// The figures of a report.
document.querySelectorAll("figure").forEach((figure, number) => {
  const source = figure.querySelector("script.panels");
  const svg = figure.querySelector("svg");
  if (source && svg) interactive(svg, JSON.parse(source.textContent), `figure-${number}-panel`);
});
