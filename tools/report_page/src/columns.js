// The measures that the page shows: one name, unit and scale for charts, lists and tables.

/** `scale` turns the value of the table into the unit of the title; `logarithmic` is how its chart is drawn. */
export const measures = [
  {key: 'seconds', title: 'Time (s)', chart: 'Runtime', scale: 1, logarithmic: true, unit: 's'},
  {key: 'cage_faces', title: 'Cage faces', chart: 'Faces of the cage', scale: 1, logarithmic: true, unit: 'faces'},
  {key: 'hausdorff_rel', title: 'Hausdorff (%)', chart: 'Hausdorff distance, both directions', scale: 100,
   unit: '% of the diagonal'},
  {key: 'normal_deviation_deg', title: 'Normals (deg)', chart: 'Mean normal deviation', scale: 1, unit: 'degrees'},
  {key: 'violation_max_rel', title: 'Beyond tau (%)', chart: 'Largest violation of tau', scale: 100,
   unit: '% of the diagonal', zeros: true},
];

export const others = [
  {key: 'input_faces', title: 'Input faces', scale: 1},
  {key: 'components', title: 'Parts', scale: 1},
  {key: 'euler_characteristic', title: 'Euler', scale: 1},
  {key: 'violation_fraction', title: 'Area beyond tau (%)', scale: 100},
  {key: 'volume_ratio', title: 'Volume ratio', scale: 1},
  {key: 'area_ratio', title: 'Area ratio', scale: 1},
  {key: 'min_angle_deg', title: 'Least angle (deg)', scale: 1},
  {key: 'peak_memory_bytes', title: 'Memory (MB)', scale: 1e-6},
];

export const measure = key => [...measures, ...others].find(entry => entry.key === key);
export const scaled = (row, {key, scale}) => row[key] === null ? null : row[key] * scale;
