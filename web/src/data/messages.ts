// SPDX-License-Identifier: Apache-2.0
// The lines of log.txt.

export interface Message {
  time: number | null; // null for a notice of the run, because notices have no time
  instance: string;
  severity: "info" | "warning" | "error";
  text: string;
}

const TIMED = /^\[\s*([\d.]+) s\] ([^:]+): (warning: |error: )?(.*)$/;
const UNTIMED = /^(notice|warning|error): (.*)$/;

export function readMessages(log: string): Message[] {
  const messages: Message[] = [];
  for (const line of log.split("\n")) {
    if (line === "") continue;
    const timed = TIMED.exec(line);
    const untimed = UNTIMED.exec(line);
    if (timed) {
      const severity = timed[3] === "warning: " ? "warning" : timed[3] === "error: " ? "error" : "info";
      messages.push({ time: Number(timed[1]), instance: timed[2], severity, text: timed[4] });
    } else if (untimed) {
      const severity = untimed[1] === "notice" ? "info" : (untimed[1] as "warning" | "error");
      messages.push({ time: null, instance: "", severity, text: untimed[2] });
    } else if (messages.length > 0) {
      messages[messages.length - 1].text += "\n" + line.trimStart(); // continues a message of several lines
    }
  }
  return messages;
}

/** Returns the text of an event without its time and place. The position of the event's mark shows both. */
export function shortText(message: Message): string {
  const text = message.text.replace(/^t = [\d.]+ s(, at \([^)]*\) m)?: /, "");
  const said = /^([\d.]+) s /.exec(text); // the clock time that some firmware prints
  return said && message.time !== null && Math.abs(Number(said[1]) - message.time) < 0.01 ? text.slice(said[0].length) : text;
}
