/** What commands ask the user. */

export type UserQuestion =
  | {
      readonly kind: "confirm";
      readonly title: string;
      readonly text: string;
      readonly yes: string;
      readonly no?: string;
      readonly danger?: boolean;
    }
  | {
      readonly kind: "choose";
      readonly title: string;
      readonly text: string;
      readonly choices: readonly {
        readonly value: string;
        readonly title: string;
        readonly detail?: string;
      }[];
    }
  | {
      readonly kind: "prompt";
      readonly title: string;
      readonly label: string;
      readonly initial?: string;
      readonly check?: (text: string) => string | null;
    };
