// SPDX-License-Identifier: Apache-2.0
// Types for the functions of the package that the page uses; the package has none.
declare module "d3-flame-graph" {
  // eslint-disable-next-line @typescript-eslint/no-explicit-any
  export default function flamegraph(): any;
}
