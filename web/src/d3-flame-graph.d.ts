// SPDX-License-Identifier: Apache-2.0
// The package ships no types; this is what the page uses of it.
declare module "d3-flame-graph" {
  // eslint-disable-next-line @typescript-eslint/no-explicit-any
  export default function flamegraph(): any;
}
