export const app = {
  name: "Hindsight",
  drives: "Drives",
  toLight: "Switch to light colours",
  toDark: "Switch to dark colours",
  connectionLost: "The connection to Hindsight is lost.",
  connectionRetry: "Your decisions so far are saved. Trying again every two seconds…",
  notFound: "There is no page at this address.",
  backToDrives: "Go to the list of drives",
  retry: "Try again",
  close: "Close",
  cancel: "Cancel",
  crashed: "This page has stopped because of a fault in it. Nothing that you decided is lost.",
  reload: "Load the page again",
  unknownError: "The server answered with an error and gave no reason. Look at its log, then try again.",
  connectionError: "The server does not answer. Check that Hindsight is running.",
} as const;

export const coach = {
  name: "How to begin",
  title: "New here?",
  keys: {
    nextMerge: "shows the next question",
    accept: "same object",
    reject: "two objects",
    undo: "takes it back",
    playPause: "plays",
    help: "all keys",
  },
  pictures: "Click a box to see where its label comes from; the wheel zooms.",
  lanes: "A click in the timeline goes there.",
  done: "Got it",
} as const;
