// The page of `prcage report` in headless Chromium: node report_page_test.mjs PROGRAM SYNTHETIC_TABLE
import assert from 'node:assert/strict';
import {spawnSync} from 'node:child_process';
import {mkdirSync, mkdtempSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, describe, it} from 'node:test';
import {Browser, findChromium} from './browser.mjs';

const [program, syntheticTable] = process.argv.slice(2);
const skipped = 77;

const chromium = findChromium();
if (!chromium) {
  console.log('skipped: there is no chromium here (Debian package chromium; or say which in CHROMIUM)');
  process.exit(skipped);
}

const scratch = mkdtempSync(join(tmpdir(), 'prcage_report_page_'));
const path = name => join(scratch, name);
process.on('exit', () => rmSync(scratch, {recursive: true, force: true}));

function run(command, args, expected = 0) {
  const {status, stderr} = spawnSync(command, args, {encoding: 'utf8'});
  assert.equal(status, expected, `${command} ${args.join(' ')}: ${stderr}`);
}

// Tabulator's names for what the page's table is made of.
const heading = (table, field) => `${table} .tabulator-col[tabulator-field="${field}"]`;
const cells = (table, field) => `[...document.querySelectorAll('${table} .tabulator-row')]
    .map(row => row.querySelector('[tabulator-field="${field}"]').textContent)`;
const column = name => `JSON.parse(document.getElementById('data').textContent).columns.${name}`;

const asksNobody = page => assert.deepEqual(page.requests, [page.url]);
const hasNoErrors = page => assert.deepEqual(page.errors, []);

async function printTimes(page, what) {
  const {firstView, complete} = await page.evaluate('({...document.documentElement.dataset})');
  console.log(`${what}: first view after ${Math.round(firstView)} ms, complete after ${Math.round(complete)} ms`);
}

let browser;
before(() => browser = new Browser(chromium));
after(() => browser.close());

describe('a table of 10,000 synthetic rows', () => {
  let page;
  before(async () => {
    run(syntheticTable, [path('synthetic.sqlite'), '10000']);
    run(program, ['report', path('synthetic.sqlite'), '-o', path('synthetic.html'), '--title', 'Ten <b>thousand</b>']);
    page = await browser.open(path('synthetic.html'));
    await printTimes(page, '10,000 rows');
  });

  it('names success and growth as they are', async () => {
    assert.equal(await page.text('#title'), 'Ten <b>thousand</b>');
    assert.match(await page.text('#summary'), /10 000/);
    assert.match(await page.text('#summary'), /95\.0 %/);
    assert.match(await page.text('#causes'), /timeout/);
    const growth = Number(await page.text('#growth'));
    assert.ok(Math.abs(growth - 1.2) < 0.03, `growth ${growth}`);
  });

  it('has a chart of each measure', async () => {
    const titles = await page.evaluate('[...document.querySelectorAll("#charts h3")].map(title => title.textContent)');
    assert.equal(titles.length, 6);
    assert.ok(await page.evaluate(
        `[...document.querySelectorAll('#charts figure')]
            .every(figure => figure.querySelectorAll('svg rect, svg circle').length > 5)`));
  });

  it('holds only the rows in sight', async () => {
    const drawn = await page.evaluate('document.querySelectorAll("#rows .tabulator-row").length');
    assert.ok(drawn > 5 && drawn < 200, `${drawn} rows`);
  });

  it('sorts, rows without a number last', async () => {
    const largest = await page.evaluate(`Math.max(...${column('input_faces')})`);
    await page.click(`${heading('#rows', 'input_faces')} .tabulator-col-title`);
    await page.until(`${cells('#rows', 'input_faces')}[0].replaceAll(' ', '') === '${largest}'`);
    const texts = await page.evaluate(cells('#rows', 'input_faces'));
    const descending = texts.map(text => Number(text.replaceAll(' ', '')));
    assert.deepEqual(descending, [...descending].sort((a, b) => b - a));

    const least = await page.evaluate(`Math.min(...${column('cage_faces')}.filter(faces => faces !== null))`);
    const most = await page.evaluate(`Math.max(...${column('cage_faces')}.filter(faces => faces !== null))`);
    await page.click(`${heading('#rows', 'cage_faces')} .tabulator-col-title`);
    await page.until(`${cells('#rows', 'cage_faces')}[0].replaceAll(' ', '') === '${most}'`);
    await page.click(`${heading('#rows', 'cage_faces')} .tabulator-col-title`);
    await page.until(`${cells('#rows', 'cage_faces')}[0].replaceAll(' ', '') === '${least}'`);
  });

  it('filters by text and by number', async () => {
    const slow = await page.evaluate(`${column('seconds')}.filter(seconds => seconds >= 50).length`);
    assert.ok(slow > 0 && slow < 10000);
    await page.type(`${heading('#rows', 'seconds')} input`, '50');
    const count = `document.getElementById('row-count').textContent.replaceAll(' ', '')`;
    await page.until(`${count}.startsWith('${slow}of10000')`);
    await page.type(`${heading('#rows', 'mesh')} input`, 'no such mesh');
    await page.until(`${count}.startsWith('0of')`);
  });

  it('lists every failure with its cause', async () => {
    const causes = await page.evaluate(cells('#failures', 'cause'));
    assert.ok(causes.length > 5 && causes.every(cause => ['timeout', 'exit code 4', 'signal 11'].includes(cause)));
  });

  it('takes no name for code', async () => {
    const name = await page.evaluate(`${column('mesh')}.find(name => name.includes('</script>'))`);
    assert.equal(await page.evaluate('window.taken_for_code'), undefined);
    await page.type(`${heading('#failures', 'mesh')} input`, name);
    await page.until(`${cells('#failures', 'mesh')}[0] === ${JSON.stringify(name)}`);
    assert.equal(await page.evaluate('window.taken_for_code'), undefined);
  });

  it('says which models cannot be shown, and why', async () => {
    await page.click('#worst button');
    await page.until(`document.getElementById('model-text').textContent.startsWith('Cannot be shown: ')`);
  });

  it('has no errors', () => hasNoErrors(page));
  it('asks for nothing but itself', () => asksNobody(page));
});

describe('a table of real results', () => {
  let page;
  before(async () => {
    mkdirSync(path('meshes'));
    // The bracket is larger than a page takes as it is.
    for (const [shape, faces] of [['sphere', 2000], ['knot', 2000], ['bracket', 24000]]) {
      run(program, ['make', shape, '--faces', String(faces), '-o', path(`meshes/${shape}.ply`)]);
    }
    writeFileSync(path('meshes/open.off'), 'OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n');
    const someFailed = 8;
    run(program, ['batch', path('meshes'), '-o', path('cages'), '--tau', '1/20', '--quiet'], someFailed);
    run(program, ['report', path('cages/batch.sqlite'), '-o', path('real.html')]);
    page = await browser.open(path('real.html'));
    await printTimes(page, 'real results');
  });

  const choose = async name => {
    await page.evaluate(`(() => {
      const select = document.getElementById('model');
      select.value = [...select.options].find(option => option.text === '${name}').value;
      select.dispatchEvent(new Event('change', {bubbles: true}));
    })()`);
  };

  it('says what became of the meshes', async () => {
    assert.match(await page.text('#summary'), /75\.0 %/);
    assert.deepEqual(await page.evaluate(cells('#failures', 'mesh')), ['open.off']);
    assert.match((await page.evaluate(cells('#failures', 'message')))[0], /boundary_edge 3/);
  });

  it('shows a model', async () => {
    await choose('knot.ply');
    assert.match(await page.text('#model-text'), /^Input: [\d ]+ faces\. Cage: \d+ faces\./);
    const {drawn} = await page.compare(await page.picture('#view'));
    assert.ok(drawn > 0.05 && drawn < 0.9, `${drawn} of the view is drawn`);
  });

  it('shows the distance to the input, with its scale', async () => {
    const before = await page.picture('#view');
    await page.click('#show-distance');
    const {different} = await page.compare(await page.picture('#view'), before);
    assert.ok(different > 0.05, `${different} of the view has changed`);
    assert.ok(await page.evaluate(`document.getElementById('scale').checkVisibility()`));
    const [, percent] = (await page.text('#scale-most')).match(/= ([\d.]+) % of the diagonal/);
    const row = await page.evaluate(`${column('mesh')}.indexOf('knot.ply')`);
    const measured = 100 * await page.evaluate(`${column('hausdorff_cage_to_input_rel')}[${row}]`);
    assert.ok(Math.abs(percent / measured - 1) < 0.05, `${percent} % here, ${measured} % measured`);
    await page.click('#show-distance');
  });

  it('cuts a section', async () => {
    const before = await page.picture('#view');
    await page.evaluate(`(() => {
      const axis = document.getElementById('section-axis');
      axis.value = 'x';
      axis.dispatchEvent(new Event('input', {bubbles: true}));
    })()`);
    const [whole, half] = [await page.compare(before), await page.compare(await page.picture('#view'), before)];
    assert.ok(half.different > 0.02 && half.drawn < whole.drawn, `${whole.drawn}, ${half.drawn}`);
  });

  it('shows large inputs simplified, and says so', async () => {
    await choose('bracket.ply');
    assert.match(await page.text('#model-text'), /^Input: [\d ]+ faces, simplified to [\d ]+ for this view/);
    assert.ok((await page.compare(await page.picture('#view'))).drawn > 0.02);
  });

  it('shows the input of a failure alone', async () => {
    await page.evaluate(`document.querySelector('#failures button').click()`);
    assert.match(await page.text('#model-text'), /No cage: invalid_input/);
  });

  it('has no errors', () => hasNoErrors(page));
  it('asks for nothing but itself', () => asksNobody(page));
});
