// Holds SARIF files against the schema, and shows that it would notice what is wrong. Arguments: files.

import assert from "node:assert/strict";
import { createRequire } from "node:module";
import { readFileSync } from "node:fs";
import Ajv from "ajv-draft-04";
import addFormats from "ajv-formats";

const schema = createRequire(import.meta.url)("@microsoft/jest-sarif/lib/schemas/sarif-2.1.0-rtm.5.json");
const ajv = new Ajv({ strict: false, allErrors: true, unicodeRegExp: false });
addFormats(ajv);
const isValid = ajv.compile(schema);

const results = new Map(process.argv.slice(2).map((file) => [file, JSON.parse(readFileSync(file, "utf8"))]));
assert.equal(results.size, 8);
for (const [file, log] of results) {
  const valid = isValid(log);
  console.log(`${valid ? "valid  " : "INVALID"} ${file}: ${log.runs[0].results.length} results`);
  assert.ok(valid, JSON.stringify(isValid.errors?.slice(0, 5), null, 1));
  for (const { ruleId, ruleIndex } of log.runs[0].results)
    assert.equal(log.runs[0].tool.driver.rules[ruleIndex].id, ruleId);
}

const counts = Object.fromEntries([...results].map(([file, log]) => [file.replace(/^.*\//, ""), log.runs[0].results.length]));
assert.ok(counts["findings.sarif"] > 1);
assert.equal(counts["clear.sarif"], 0);
assert.equal(counts["empty.sarif"], 0);
assert.equal(counts["cut.sarif"], 25000);
assert.equal(counts["broken.sarif"], 1);
assert.equal(counts["nowhere.sarif"], 1);
assert.equal(counts["shop.sarif"], 2 * counts["findings.sarif"] + 1);

// Every kind of mistake that a writer of SARIF makes is seen; else the schema would prove nothing.
const mistakes = {
  "a version that is none": (log) => { log.version = "2.0.0"; },
  "no runs": (log) => { delete log.runs; },
  "a schema that is no URI": (log) => { log.$schema = "sarif 2.1.0"; },
  "a tool without a name": (log) => { delete log.runs[0].tool.driver.name; },
  "a rule without an id": (log) => { delete log.runs[0].tool.driver.rules[0].id; },
  "help that is a plain string": (log) => { log.runs[0].tool.driver.rules[0].help = "Look."; },
  "a result without a message": (log) => { delete log.runs[0].results[0].message; },
  "a level that is none": (log) => { log.runs[0].results[0].level = "fatal"; },
  "a key that is none": (log) => { log.runs[0].results[0].severity = "error"; },
  "a rule index below all": (log) => { log.runs[0].results[0].ruleIndex = -2; },
  "line 0": (log) => { placeOf(log).region.startLine = 0; },
  "a line that is text": (log) => { placeOf(log).region.startLine = "7"; },
  "a name that is no URI": (log) => { placeOf(log).artifactLocation.uri = "more notes.nc"; },
  "a base that is no URI": (log) => { log.runs[0].originalUriBaseIds["%SRCROOT%"].uri = "/home/me/my shop/"; },
  "a fingerprint that is a number": (log) => { log.runs[0].results[0].partialFingerprints["feeler/v1"] = 7; },
  "an invocation without success or failure": (log) => { delete log.runs[0].invocations[0].executionSuccessful; },
  "a time that is none": (log) => { log.runs[0].invocations[0].endTimeUtc = "yesterday"; },
};
function placeOf(log) {
  return log.runs[0].results[0].locations[0].physicalLocation;
}
for (const [name, spoil] of Object.entries(mistakes)) {
  const log = structuredClone(results.get("./findings.sarif"));
  spoil(log);
  assert.equal(isValid(log), false, `the schema takes ${name}`);
}
console.log(`${results.size} files are valid, and ${Object.keys(mistakes).length} mistakes were seen`);
