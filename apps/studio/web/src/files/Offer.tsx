// Offers changes that would else be lost: of an earlier run of the server, or of this window.
import { ageOf } from "../model/time";
import { answerOffer, useStudio } from "../model/store";
import { addressOfPicture } from "../protocol/client";
import { kUntitled } from "../share/thumbnail";
import { Dialog } from "./Dialog";

export function Offer() {
  const offer = useStudio((s) => s.offer);
  const path = useStudio((s) => s.sceneState.path);
  if (!offer) return null;
  const nodes = Object.keys(offer.scene.nodes).length;
  const later = () => answerOffer("later");
  return (
    <Dialog title="Changes that were not saved" onClose={later}>
      <h2>Changes that were not saved</h2>
      {offer.picture !== undefined && <img className="last-seen" src={addressOfPicture(path || kUntitled, offer.picture)} alt="What its run looked like" width={320} height={180} />}
      <p>
        {offer.from === "draft" ? "There are changes to this scene that were not saved" : "This window has changes that the server does not have"}
        {offer.written !== undefined && `, made ${ageOf(offer.written)}`}: <b>{offer.scene.title ?? "Untitled"}</b>, {nodes} {nodes === 1 ? "node" : "nodes"}.
      </p>
      <button data-first className="wanted" onClick={() => answerOffer("restore")}>Restore</button>{" "}
      <button onClick={later} title="They are kept">Not now</button>{" "}
      <button onClick={() => answerOffer("delete")}>Delete</button>
    </Dialog>
  );
}
