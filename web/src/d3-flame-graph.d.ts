// SPDX-License-Identifier: Apache-2.0
// Declares the functions that the page uses, because the package has no types.
declare module "d3-flame-graph" {
  // eslint-disable-next-line @typescript-eslint/no-explicit-any
  export default function flamegraph(): any;
}
