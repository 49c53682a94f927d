/** List of dicts as a table with one column per key. */

import type { Records } from "../../../model/numbers.ts";
import { shortValue } from "../../../model/short_value.ts";

export function RecordsTable({ records, name }: { records: Records; name: string }) {
  return (
    // biome-ignore lint/a11y/noNoninteractiveTabindex: scrolling by keyboard needs the focus
    <section className="value-scroll" aria-label={`${name} as a table`} tabIndex={0}>
      <table className="value-table value-records">
        <thead>
          <tr>
            <th scope="col"> </th>
            {records.keys.map((key) => (
              <th key={key} scope="col">
                {key}
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {records.rows.map((row, index) => (
            // biome-ignore lint/suspicious/noArrayIndexKey: a record is identified by its index
            <tr key={index}>
              <th scope="row">{index}</th>
              {records.keys.map((key) => (
                <td key={key}>{row.has(key) ? <code>{shortValue(row.get(key))}</code> : null}</td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
    </section>
  );
}
