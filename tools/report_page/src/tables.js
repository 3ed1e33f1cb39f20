// The tables that sort and filter. Only the rows in sight are in the document: ten thousand are as quick as ten.
import {EditModule, FilterModule, FormatModule, FrozenColumnsModule, InteractionModule, ResizeColumnsModule,
        SortModule, Tabulator} from 'tabulator-tables';
import {measures, others, scaled} from './columns.js';
import {pretty} from './data.js';
import {nameOf} from './summary.js';

Tabulator.registerModule([EditModule, FilterModule, FormatModule, FrozenColumnsModule, InteractionModule,
                          ResizeColumnsModule, SortModule]);

/** "5" is "at least 5", "<5" is "at most 5"; a row without the number fails both. */
function numberFilter(wanted, value) {
  const atMost = wanted.startsWith('<');
  const limit = Number(atMost ? wanted.slice(1) : wanted);
  if (Number.isNaN(limit)) return true;
  if (value === null) return false;
  return atMost ? value <= limit : value >= limit;
}

/** Rows without a number come last, whatever the direction. */
function numberSorter(a, b, _rowA, _rowB, _column, direction) {
  if (a !== null && b !== null) return a - b;
  const last = direction === 'asc' ? 1 : -1;
  return last * ((a === null) - (b === null));
}

const numberColumn = ({key, title}) => ({
  title, field: key, hozAlign: 'right', sorter: numberSorter, headerSortStartingDir: 'desc', width: 116,
  formatter: cell => pretty(cell.getValue()), headerFilter: 'input', headerFilterFunc: numberFilter,
  headerFilterPlaceholder: '\u2265',
});

const textColumn = (title, field, width) => ({
  title, field, width, headerFilter: 'input', headerFilterPlaceholder: 'contains',
  formatter: 'plaintext',
});

const nameColumn = (data, show) => ({
  ...textColumn('Mesh', 'mesh', 280), frozen: true,
  formatter: cell => nameOf(data.rows[cell.getRow().getData().index], data, show),
});

const settingsColumn = data => data.settings.length > 1 ? [textColumn('Settings', 'options', 150)] : [];

/** Why there is no cage, as far as the table knows. */
function causeOf(row) {
  if (row.cause === null) return row.evaluation_failure ?? '';
  if (row.cause === 'signal') return `signal ${row.signal}`;
  return row.cause === 'exit code' ? `exit code ${row.exit_code}` : row.cause;
}

/** What the tables show of a row, in the units of their headings. */
function shown(row, data) {
  const line = {index: row.index, mesh: row.mesh, status: row.status, cause: causeOf(row),
                options: data.labels[row.settings], message: [row.message, row.defects].filter(Boolean).join('; '),
                process_seconds: row.process_seconds};
  for (const column of [...measures, ...others]) line[column.key] = scaled(row, column);
  return line;
}

function table(place, columns, lines, height) {
  return new Tabulator(place, {data: lines, columns, height, index: 'index', layout: 'fitDataFill',
                               columnDefaults: {headerSortTristate: true, headerWordWrap: true}});
}

/** Every row; calls `counted` with the number of rows that pass the filters. */
export function drawRows(place, data, show, counted) {
  const columns = [nameColumn(data, show), ...settingsColumn(data), textColumn('Status', 'status', 120),
                   textColumn('Cause', 'cause', 120), numberColumn(others[0]),
                   ...[...measures, ...others.slice(1)].map(numberColumn)];
  const made = table(place, columns, data.rows.map(row => shown(row, data)), '560px');
  made.on('dataFiltered', (_, rows) => counted(rows.length));
  counted(data.rows.length);
  return made;
}

/** Every row without a cage, and what is known of it. */
export function drawFailures(place, data, failures, show) {
  const columns = [nameColumn(data, show), ...settingsColumn(data), textColumn('Status', 'status', 150),
                   textColumn('Cause', 'cause', 120), textColumn('Message', 'message', 560),
                   numberColumn(others[0]), numberColumn({key: 'process_seconds', title: 'Time (s)'})];
  return table(place, columns, failures.map(row => shown(row, data)), failures.length > 12 ? '400px' : undefined);
}
