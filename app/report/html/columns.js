// Unpacking of columns of numbers, and numbers as text.

/** Expands runs [value, count, ...] to one number per block. */
function unpackRuns(runs, count) {
  const column = new Int32Array(count);
  let next = 0;
  for (let i = 0; i < runs.length; i += 2) {
    column.fill(runs[i], next, next + runs[i + 1]);
    next += runs[i + 1];
  }
  return column;
}

/** Replaces each step by the sum of all steps up to it. */
function summed(steps) {
  let sum = 0;
  for (let i = 0; i < steps.length; ++i) steps[i] = sum += steps[i];
  return steps;
}

function millimetres(um) {
  return (um / 1000).toFixed(3);
}

function secondsText(seconds) {
  if (seconds < 60) return seconds.toFixed(2) + " s";
  if (seconds >= 3.6e9) return "more than 1,000,000 h";
  const whole = Math.round(seconds), minutes = Math.floor(whole / 60);
  if (minutes < 60) return minutes + " min " + String(whole % 60).padStart(2, "0") + " s";
  return Math.floor(minutes / 60) + " h " + String(minutes % 60).padStart(2, "0") + " min";
}
