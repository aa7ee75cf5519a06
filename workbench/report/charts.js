// Draws the charts of a report from the figures in the page.
(() => {
  'use strict';
  const { scenes } = JSON.parse(document.getElementById('figures').textContent);
  const rayTypes = ['primary', 'ao', 'diffuse'];
  const dark = matchMedia('(prefers-color-scheme: dark)');

  // Colours that the colour-blind can distinguish (Okabe & Ito 2008); grey for the plain BVH, the base of comparison.
  const palette = {
    bvh: ['#8b9199', '#8b9199'],
    sbvh: ['#0072b2', '#4fb0e3'],
    esc: ['#e69f00', '#f0b53c'],
    evh: ['#b5548f', '#d98cba'],
  };
  const others = [['#0072b2', '#4fb0e3'], ['#e69f00', '#f0b53c'], ['#009e73', '#3cc9a0'], ['#b5548f', '#d98cba'], ['#8b9199', '#8b9199']];
  const shade = (pair) => pair[dark.matches ? 1 : 0];
  const colourOf = (builder, i) => shade(palette[builder.name] || others[i % others.length]);
  const light = (colour) => colour + '66';
  const style = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const relative = (value, base) => (base > 0 ? value / base : null);

  const bars = (labels, datasets, unit) => ({
    type: 'bar',
    data: { labels, datasets },
    options: {
      datasets: { bar: { categoryPercentage: 0.78, barPercentage: 0.92, borderRadius: 2 } },
      scales: { x: { grid: { display: false }, ticks: { maxRotation: 0 } }, y: { beginAtZero: true, title: { display: !!unit, text: unit } } },
    },
  });

  const lines = (scene, series) => ({
    type: 'line',
    data: {
      labels: scene.builders.map(({ alpha }) => (alpha > 0 && alpha < 0.01 ? alpha.toExponential() : String(alpha))),
      datasets: series.map(([label, value], i) => ({
        label,
        data: scene.builders.map((b) => relative(value(b), value(scene.builders[0]))),
        borderColor: shade(others[i]),
        backgroundColor: shade(others[i]),
        borderWidth: 2,
        pointRadius: 3,
      })),
    },
    options: { scales: { x: { title: { display: true, text: 'α' }, ticks: { maxRotation: 0 } }, y: { title: { display: true, text: 'relative' } } } },
  });

  const kinds = {
    tree(scene) {
      const measures = [['SAH', 'sah'], ['EPO', 'epo'], ['LCV', 'lcv'], ['refs', 'references'], ['nodes', 'nodes']];
      return bars(
        measures.map(([title]) => title),
        scene.builders.map((b, i) => ({
          label: b.name,
          data: measures.map(([, key]) => relative(b[key], scene.builders[0][key])),
          backgroundColor: colourOf(b, i),
        })));
    },
    work(scene) {
      const part = (key, paint) => scene.builders.map((b, i) => ({
        label: b.name,
        stack: b.name,
        data: rayTypes.map((type) => b.rays[type][key]),
        backgroundColor: paint(colourOf(b, i)),
      }));
      const chart = bars(rayTypes, [...part('steps', (c) => c), ...part('triangle_tests', light)]);
      const count = scene.builders.length;
      chart.options.scales.x.stacked = true;
      chart.options.scales.y.stacked = true;
      chart.options.plugins = {
        legend: { labels: { filter: (item) => item.datasetIndex < count } },
        tooltip: {
          callbacks: {
            label: (item) => `${item.dataset.label} ${item.datasetIndex < count ? 'steps' : 'triangle tests'}: ${item.parsed.y.toFixed(2)}`,
          },
        },
      };
      return chart;
    },
    speed(scene) {
      return bars(rayTypes, scene.builders.map((b, i) => ({
        label: b.name,
        data: rayTypes.map((type) => b.rays[type].mrays_per_s),
        backgroundColor: colourOf(b, i),
      })));
    },
    'sweep-cost': (scene) => lines(scene, [['SAH', (b) => b.sah], ['references', (b) => b.references]]),
    'sweep-speed': (scene) => lines(scene, rayTypes.map((type) => [type, (b) => b.rays[type].mrays_per_s])),
  };

  let charts = [];
  const draw = () => {
    charts.forEach((chart) => chart.destroy());
    Chart.defaults.animation = false;
    Chart.defaults.maintainAspectRatio = false;
    Chart.defaults.font.family = style('--sans');
    Chart.defaults.color = style('--muted');
    Chart.defaults.borderColor = style('--line');
    Chart.defaults.plugins.legend.labels.boxWidth = 12;
    Chart.defaults.plugins.legend.labels.boxHeight = 12;
    Chart.defaults.plugins.legend.position = 'bottom';
    charts = [...document.querySelectorAll('canvas[data-chart]')].map(
      (canvas) => new Chart(canvas, kinds[canvas.dataset.chart](scenes[canvas.dataset.scene])));
  };

  // A canvas counts as drawn when any of its pixels is not transparent.
  const isDrawn = (canvas) => {
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    return data.some((byte) => byte !== 0);
  };

  draw();
  dark.addEventListener('change', draw);
  addEventListener('load', () => {
    const shown = [...document.images].filter((image) => image.complete && image.naturalWidth > 0);
    document.documentElement.dataset.chartsDrawn = charts.filter((chart) => isDrawn(chart.canvas)).length;
    document.documentElement.dataset.picturesShown = shown.length;
  });
})();
